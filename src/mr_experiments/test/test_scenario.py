"""Scenario files: those of the package can be run, and a bad one is told with the key that is wrong."""

import math

import pytest

from mr_experiments.trial.radio_options import RadioOptions
from mr_experiments.trial.scenario import known_scenarios, load_scenario
from mr_experiments.trial.trial import TrialError
from mr_experiments.trial.trial_world import world_of

SCENARIOS = sorted(known_scenarios())


@pytest.fixture
def scenario_file(tmp_path):
    def write(text):
        path = tmp_path / "made.yaml"
        path.write_text(text, encoding="utf-8")
        return str(path)

    return write


def test_there_are_scenarios():
    assert {"paper", "radio", "death", "late", "strategies"} <= set(SCENARIOS)


@pytest.mark.parametrize("name", SCENARIOS)
def test_every_scenario_makes_its_trials(name):
    scenario = load_scenario(name)
    assert scenario.name == name and scenario.description
    for robots in scenario.robots:
        for strategy in scenario.strategies:
            trial = scenario.trial(robots, strategy, seed=1)
            assert (trial.robots, trial.strategy, trial.scenario) == (robots, strategy, name)
            assert all(robot < robots for robot in [*trial.joins, *trial.deaths])
    world = world_of(scenario.trial(max(scenario.robots), scenario.strategies[0], seed=1))
    places = {(round(x, 2), round(y, 2)) for x, y, _ in map(world.pose, range(max(scenario.robots)))}
    assert len(places) == max(scenario.robots)


def test_trials_of_a_scenario_have_names_of_their_own():
    trials = [load_scenario(name).trial(2, 7, seed) for name in SCENARIOS for seed in (1, 2)]
    assert len({trial.key for trial in trials}) == len(trials)


def test_all_keys(scenario_file):
    scenario = load_scenario(
        scenario_file(
            "description: all keys\nworld: small8x8\nrobots: [2]\nstrategies: [1, 7]\nlimit: 60\nfast: false\n"
            "known_poses: true\nradio: {range: 5, loss: 0.1, bit_rate: 1e6, contention: true,"
            " sealed: false}\ntopology: centralized\nbase: [2, 1.5]\n"
            "partition: [10, 20.5]\n"
            "odometry: random_walk\n"
            "starts: [[1, 2, 90], [3, 4.5, -180]]\njoins: {1: 5}\ndeaths: {0: 9.5}\n"
        )
    )
    assert scenario.radio == RadioOptions(5.0, 0.1, 1e6, 0.0, True, False)
    assert scenario.starts == ((1.0, 2.0, math.radians(90.0)), (3.0, 4.5, -math.pi))
    assert (scenario.joins, scenario.deaths) == ({1: 5.0}, {0: 9.5})
    assert scenario.odometry == scenario.trial(2, 7, 1).odometry == "random_walk"
    assert scenario.partition == scenario.trial(2, 7, 1).partition == (10.0, 20.5)
    assert (scenario.topology, scenario.base) == ("centralized", (2.0, 1.5))
    assert (scenario.name, scenario.strategies, scenario.known_poses, scenario.limit) == ("made", (1, 7), True, 60.0)
    alone = scenario.trial(1, 7, 1)
    assert alone.joins == {} and len(alone.starts) == 1


def test_the_seed_draws_the_time_of_a_death(scenario_file):
    scenario = load_scenario(scenario_file("description: x\ndeaths: {0: [5, 50], 1: 7}\n"))
    times = [scenario.trial(2, 7, seed).deaths for seed in range(20)]
    assert all(5.0 <= death[0] <= 50.0 and death[1] == 7.0 for death in times)
    assert len({death[0] for death in times}) > 10 and scenario.trial(2, 7, 3).deaths == times[3]


def test_radio_without_limits(scenario_file):
    assert math.isinf(load_scenario(scenario_file("description: x\nradio: {range: .inf}\n")).radio.range)


@pytest.mark.parametrize(
    "text, told",
    [
        ("", "a scenario is a mapping"),
        ("[1, 2]", "a scenario is a mapping"),
        ("a: [", "made.yaml: while parsing"),
        ("world: small8x8", "'description' is missing"),
        ("description: 5", "description: expected a text, not 5"),
        ("description: x\nrobot: [1]", "unknown key 'robot'; there are .*robots"),
        ("description: x\n5: [1]", "unknown key 5"),
        ("description: x\nworld: 8", "world: expected a text, not 8"),
        ("description: x\nrobots: 3", "robots: expected a list of whole numbers, not 3"),
        ("description: x\nrobots: [1, true]", "robots: expected a list of whole numbers"),
        ("description: x\nrobots: [0]", "robots: a team has at least one robot, not 0"),
        ("description: x\nstrategies: [12]", "strategies: 12 is unknown; there are 0, 1"),
        ("description: x\nlimit: long", "limit: expected a number, not 'long'"),
        (f"description: x\nlimit: {10**400}", "limit: expected a number, not 1000"),
        ("description: x\nlimit: true", "limit: expected a number, not True"),
        ("description: x\nlimit: -5", "limit: expected a positive number, not -5"),
        ("description: x\nlimit: .inf", "limit: expected a finite number"),
        ("description: x\nfast: 1", "fast: expected true or false, not 1"),
        ("description: x\nknown_poses: maybe", "known_poses: expected true or false"),
        ("description: x\nbase: [1, 2, 3]", "base: expected .x, y. in m, not"),
        ("description: x\nbase: [1, .inf]", "base: expected finite numbers"),
        ("description: x\nradio:", "radio: expected a mapping with some of range"),
        ("description: x\nradio: {reach: 5}", "radio: unknown key 'reach'; there are range"),
        ("description: x\nradio: {loss: 1.5}", "radio: loss: expected a number between 0 and 1, not 1.5"),
        ("description: x\nradio: {range: far}", "radio: range: expected a number, not 'far'"),
        ("description: x\nradio: {range: .nan}", "radio: range: expected a number, not nan"),
        ("description: x\nradio: {sealed: 0}", "radio: sealed: expected true or false"),
        ("description: x\nstarts: here", "starts: expected a list of .x, y, degrees."),
        ("description: x\nstarts: [[1, 2]]", "starts: expected .x, y, degrees., not .1, 2."),
        ("description: x\nstarts: [[1, 2, .inf]]", "starts: expected finite numbers"),
        ("description: x\njoins: [1]", "joins: expected robot: seconds, not .1."),
        ("description: x\njoins: {one: 5}", "joins: expected the index of a robot, 0 or above, not 'one'"),
        ("description: x\ndeaths: {-1: 5}", "deaths: expected the index of a robot"),
        ("description: x\ndeaths: {1: soon}", "deaths: robot 1: expected a number, not 'soon'"),
        ("description: x\ndeaths: {1: [5, 2]}", "deaths: robot 1: expected a time and a later one"),
        ("description: x\ndeaths: {1: [5]}", "deaths: robot 1: expected .from, to. in s"),
        ("description: x\npartition: 60", "partition: expected .from, to. in s, not 60"),
        ("description: x\ndeaths: {1: -2}", "deaths: robot 1: expected a positive number"),
    ],
)
def test_bad_file_is_told_with_its_key(scenario_file, text, told):
    with pytest.raises(TrialError, match=f"made.yaml: .*{told}" if "made.yaml" not in told else told) as error:
        load_scenario(scenario_file(text))
    assert "\n" not in str(error.value)


def test_unknown_name_lists_the_known_ones():
    with pytest.raises(TrialError, match=r"no scenario 'nothing'; there are .*paper.*or name a .yaml file"):
        load_scenario("nothing")


def test_missing_file_is_named(tmp_path):
    with pytest.raises(TrialError, match=r"gone.yaml: No such file"):
        load_scenario(str(tmp_path / "gone.yaml"))


def test_too_few_start_poses_are_told(scenario_file):
    scenario = load_scenario(scenario_file("description: x\nworld: small8x8\nstarts: [[0, 0, 0]]\n"))
    with pytest.raises(TrialError, match="gives 1 start pose; 2 robots"):
        world_of(scenario.trial(2, 7, 1))
