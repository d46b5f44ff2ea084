# People's entry points. `make demo` and `make test` set everything up by themselves.
.PHONY: demo test build dependencies lint bench bench-adhoc bench-merge bench-explore bench-sim clean

SHELL := /bin/bash
ENVIRONMENT := source tools/environment.sh &&

demo: build
	@$(ENVIRONMENT) rosrun mr_launch team --world office26x15 --robots 3 --range 10 --loss 0.05 $(DEMO_ARGUMENTS)

test: build
	@$(ENVIRONMENT) tools/test

build: dependencies
	@echo "Building (log: build/build.log)"
	@tools/build

dependencies:
	@tools/install_dependencies

lint: dependencies
	@$(ENVIRONMENT) tools/lint

clean:
	rm -rf build
