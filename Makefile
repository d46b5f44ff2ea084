# People's entry points. `make demo` and `make test` set everything up by themselves.
.PHONY: demo test test-commands build dependencies lint sanitize fuzz scenarios bench bench-adhoc bench-adhoc-long bench-merge bench-meet bench-explore bench-explore-cpu bench-hardship bench-buildings bench-slam bench-slam-peers bench-navigation bench-navigation-peers bench-sim bench-guard bench-page bench-doctor soak nightly experiments clean

SHELL := /bin/bash
ENVIRONMENT := source tools/environment.sh &&

demo: build
	@$(ENVIRONMENT) rosrun mr_launch team --world office26x15 --robots 3 --range 10 --loss 0.05 $(DEMO_ARGUMENTS)

test: build
	@tools/install_dependencies browser
	@$(ENVIRONMENT) tools/readable_by_all tools/test

# Runs the commands of the README, of the tutorials and of all tables, shortened: five minutes.
test-commands: build
	@tools/install_dependencies browser
	@$(ENVIRONMENT) python3 -m pytest -q test/commands

build: dependencies
	@echo "Building (log: build/build.log)"
	@tools/build

dependencies:
	@tools/install_dependencies

# Each prints its table and writes rows of JSON below out/bench.
bench: bench-adhoc bench-merge bench-explore bench-explore-cpu bench-hardship bench-buildings bench-slam bench-navigation bench-sim bench-guard bench-page bench-doctor

RADIO_PARTS = base goodput multicast mixed_rates routes wifi channels idle priority
RADIO_ROWS = $(patsubst %,out/bench/adhoc%.json,_adversaries _scenarios $(addprefix _,$(RADIO_PARTS)) _memory _medium _hosts _babel) out/bench/adhoc.json
# Each row of docs/results/radio.md is measured by one of bench-adhoc, bench-adhoc-long and fuzz, which leave those of the others
# as they are.
PUBLISH_RADIO = publish() { rosrun mr_experiments publish bench --update "$$@" docs/results/data/radio.csv && \
	rosrun mr_experiments publish pages docs/results/radio.md; }; publish

# An hour on two idle cores.
bench-adhoc: build
	@tools/install_dependencies babel
	@tools/build --target adhoc_communication_benchmarks adhoc_communication_engine_test engine_scenarios
	@mkdir -p out/bench && $(ENVIRONMENT) missed=0; \
	rosrun adhoc_communication bench_adversaries --out out/bench/adhoc_adversaries.json || missed=1; \
	build/devel/lib/adhoc_communication/engine_scenarios --contention --seed 10001 --count 1000 --keep-going --json out/bench/adhoc_scenarios.json || missed=1; \
	rosrun adhoc_communication bench_namespaces --out out/bench/adhoc.json || missed=1; \
	rosrun adhoc_communication bench_hosts --out out/bench/adhoc_hosts.json || missed=1; \
	rosrun adhoc_communication bench_namespaces --only babel --kills 30 --out out/bench/adhoc_babel.json || missed=1; \
	rosrun adhoc_communication bench_memory --json out/bench/adhoc_memory.json || missed=1; \
	rosrun adhoc_communication bench_medium --json out/bench/adhoc_medium.json || missed=1; \
	for part in $(RADIO_PARTS); do \
	  rosrun adhoc_communication bench_engine --part $$part --json out/bench/adhoc_$$part.json || missed=1; \
	done; \
	$(PUBLISH_RADIO) $$(ls $(RADIO_ROWS)); \
	exit $$missed

# A thousand transfers for each number of hops and each loss, a hundred robots for ten virtual minutes, for which they may take an
# hour of processor time: about two hours.
bench-adhoc-long: build
	@tools/build --target adhoc_communication_benchmarks
	@mkdir -p out/bench && $(ENVIRONMENT) missed=0; \
	rosrun adhoc_communication bench_engine --part intact --trials 1000 --json out/bench/adhoc_intact.json || missed=1; \
	rosrun adhoc_communication bench_engine --part mobile --minutes 10 --patience 3600 --json out/bench/adhoc_mobile.json || missed=1; \
	$(PUBLISH_RADIO) out/bench/adhoc_intact.json out/bench/adhoc_mobile.json; \
	exit $$missed

# REAL_LOGS=DIR: also pairs of pieces of the CARMEN logs in that folder.
bench-merge: build
	@mkdir -p out/bench && $(ENVIRONMENT) missed=0; \
	rosrun map_merger bench_registration --out out/bench/merge.json $(if $(REAL_LOGS),--real-logs $(REAL_LOGS)) || missed=1; \
	rosrun map_merger bench_fusion --out out/bench/fusion.json || missed=1; \
	rosrun map_merger bench_exchange --out out/bench/exchange.json || missed=1; \
	rosrun map_merger bench_team --out out/bench/team.json || missed=1; \
	exit $$missed

# How soon robots find one another, in missions in virtual time: an hour and a half on two cores. Goes on where it was stopped.
bench-meet: build
	@mkdir -p out/bench && $(ENVIRONMENT) rosrun mr_experiments bench merging --out out/bench/merging.json $(MEET)

# Missions of the ROS stack, then thirty generated worlds in virtual time: an hour or two on two cores. Goes on where it was
# stopped. EXPLORE: options of bench explore.
bench-explore: build
	@mkdir -p out/bench && $(ENVIRONMENT) missed=0; \
	tools/bench_missions --out out/bench/missions.json || missed=1; \
	rosrun mr_experiments bench explore --out out/bench/explore.json $(EXPLORE) || missed=1; \
	exit $$missed

# Missions with a bad radio, a robot that dies, a partition, a huge floor, in virtual time: a quarter of an hour on two cores.
bench-hardship: build
	@mkdir -p out/bench && $(ENVIRONMENT) rosrun mr_experiments bench hardship --out out/bench/hardship.json

# Missions in other buildings, with other robots and larger teams, in virtual time: hours. Goes on where it was stopped.
# BUILDINGS="--trials 3 --only turtlebot mixed" runs a part; BUILDINGS="--odometry bias random_walk" both models of odometry.
bench-buildings: build
	@mkdir -p out/bench && $(ENVIRONMENT) rosrun mr_experiments bench buildings --out out/bench/buildings.json $(BUILDINGS)

# How long one robot of eight takes to decide on a map of 2000 x 2000 cells: two minutes.
bench-explore-cpu: build
	@mkdir -p out/bench && $(ENVIRONMENT) OMP_NUM_THREADS=1 rosrun mr_experiments bench decisions --out out/bench/decisions.json

# SLAM on scans and odometry of missions, which are recorded first: two hours. SLAM="--missions 1": a part.
bench-slam: build
	@mkdir -p out/bench && $(ENVIRONMENT) OMP_NUM_THREADS=1 rosrun mr_experiments bench slam --out out/bench/slam.json $(SLAM)

# On the same logs beside MRPT's ICP and RBPF, which take a minute a log. REAL_LOGS=DIR: also the CARMEN logs in that folder.
bench-slam-peers: build
	@tools/build_slam_peers
	@mkdir -p out/bench && $(ENVIRONMENT) OMP_NUM_THREADS=1 PYTHONPATH=build/slam_peers:$$PYTHONPATH \
	  rosrun mr_experiments bench slam --peers --out out/bench/slam_peers.json $(if $(REAL_LOGS),--real-logs $(REAL_LOGS)) $(SLAM)

# Where robots get stuck: two hundred scenes drawn from seeds with Pioneers and with Turtlebots, three minutes.
bench-navigation: build
	@mkdir -p out/bench && $(ENVIRONMENT) missed=0; \
	rosrun mr_sim bench_navigation --jobs 2 --out out/bench/navigation.json || missed=1; \
	rosrun mr_sim bench_navigation --jobs 2 --robot turtlebot --out out/bench/navigation_turtlebot.json || missed=1; \
	exit $$missed

# The same beside planners of OMPL and MRPT's reactive navigator: a quarter of an hour. NAVIGATION: options.
bench-navigation-peers: build
	@tools/build_navigation_peers
	@mkdir -p out/bench && $(ENVIRONMENT) PYTHONPATH=build/navigation_peers:$$PYTHONPATH \
	  rosrun mr_sim bench_navigation_peers --jobs 2 --out out/bench/navigation_peers.json $(NAVIGATION)

bench-sim: build
	@mkdir -p out/bench && $(ENVIRONMENT) rosrun mr_experiments bench speed --out out/bench/sim.json

# The seeded missions whose outcome is stored: how much processor time they take. A minute or two of one core.
bench-guard: build
	@mkdir -p out/bench && $(ENVIRONMENT) python3 src/mr_experiments/test/test_guard.py --out out/bench/guard.json

# The status page of eight robots in a headless Chromium: two minutes. Its figures are those of an idle computer only.
bench-page: build
	@tools/install_dependencies browser
	@mkdir -p out/bench && $(ENVIRONMENT) rosrun mr_page bench_page --out out/bench/page.json

# Set-ups that are really broken, one by one, as root: three minutes.
bench-doctor: build
	@mkdir -p out/bench && $(ENVIRONMENT) src/mr_launch/test/bench_doctor.py --out out/bench/doctor.json

# Missions with all that goes wrong in the field, as root: two hours. SOAK_MINUTES=10, as nightly, runs each kind once,
# and has no verdict on memory, which takes 30.
SOAK_MINUTES ?= 120
soak: build
	@mkdir -p out/bench && $(ENVIRONMENT) missed=0; \
	rosrun mr_launch soak --alone --out out/bench/alone.json || missed=1; \
	rosrun mr_launch soak --minutes $(SOAK_MINUTES) --out out/bench/soak.json || missed=1; \
	exit $$missed

nightly:
	@$(MAKE) test-commands
	@$(MAKE) soak SOAK_MINUTES=10

lint: dependencies
	@$(ENVIRONMENT) tools/lint

# The tests of the protocol engine under AddressSanitizer and UndefinedBehaviorSanitizer.
sanitize: dependencies
	@PATH=/usr/bin:$$PATH cmake -S . -B build/sanitized -G Ninja -DPYTHON_EXECUTABLE=/usr/bin/python3 -DADHOC_SANITIZE=ON \
	  -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCATKIN_WHITELIST_PACKAGES=adhoc_communication > build/sanitized.log
	@cmake --build build/sanitized --target adhoc_communication_engine_test >> build/sanitized.log
	@build/sanitized/devel/lib/adhoc_communication/adhoc_communication_engine_test --gtest_brief=1

# Fuzzes the protocol engine: FUZZ_SECONDS for each target, entered into test/fuzz/runs.csv and the table of the radio. What it
# learns stays in build/fuzz; FUZZ=--merge stores it, too.
FUZZ_SECONDS ?= 600
fuzz: build
	@tools/install_dependencies fuzz
	@mkdir -p out/bench && $(ENVIRONMENT) missed=0; \
	PATH=/usr/bin:$$PATH src/adhoc_communication/test/fuzz/run_fuzz.py --build build/fuzz --seconds $(FUZZ_SECONDS) \
	  --json out/bench/adhoc_fuzz.json $(FUZZ) || missed=1; \
	$(PUBLISH_RADIO) out/bench/adhoc_fuzz.json; \
	exit $$missed

# Random teams on the simulated radio, one for each seed, all promises checked after every event.
SCENARIOS ?= 1000
scenarios: build
	@cmake --build build --target engine_scenarios > build/scenarios.log
	@build/devel/lib/adhoc_communication/engine_scenarios --count $(SCENARIOS)

# The paper's trials in virtual time, then the report. A run that was stopped goes on where it was.
EXPERIMENTS ?=
EXPERIMENTS_OUT ?= out/experiments
experiments: build
	@$(ENVIRONMENT) rosrun mr_experiments run --out $(EXPERIMENTS_OUT) $(EXPERIMENTS); status=$$?; \
	[ $$status -le 1 ] && rosrun mr_experiments report $(EXPERIMENTS_OUT) && exit $$status

clean:
	rm -rf build
