"""What a user asks of stageros, and what is told of it."""

import math

import pytest

from mr_sim import stageros_options as options
from mr_sim.stageros_options import Arguments, OptionError, Prefixes


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["a.world"], Arguments("a.world", False, ())),
        (["-g", "a.world"], Arguments("a.world", False, ())),
        (["-g", "-u", "a.world"], Arguments("a.world", True, ())),
        (["a.world", "-g"], Arguments("a.world", False, ())),
        (["--clock", "-x", "3", "a.world"], Arguments("a.world", False, ("--clock", "-x", "3"))),
        (["b.world", "-g", "a.world"], Arguments("a.world", False, ("b.world",))),
        (["a.world", "a.world"], Arguments("a.world", False, ("a.world",))),
    ],
)
def test_the_last_word_is_the_world_and_what_stageros_does_not_know_is_passed_over(words, expected):
    assert options.read_arguments(words) == expected


@pytest.mark.parametrize("words", [[], ["-g"], ["-g", "-u", "--clock"]])
def test_without_a_world_it_says_how_it_is_called(words, capsys):
    with pytest.raises(SystemExit):
        options.read_arguments(words)
    assert "stageros [-h] [-g] [-u] WORLD" in capsys.readouterr().err


def test_defaults():
    assert options.options_of({}) == options.Options(0.5, None, None, 0, "bias")


@pytest.mark.parametrize(("value", "seconds"), [(0.2, 0.2), (1, 1.0), (0, math.inf), (-1.0, math.inf), (0.0, math.inf)])
def test_watchdog_of_0_and_less_is_none_as_in_stageros(value, seconds):
    assert options.options_of({"base_watchdog_timeout": value}).command_timeout == seconds


def test_a_speedup_of_the_world_is_not_taken_for_a_parameter():
    """Worlds with `speedup -1` were refused, with a sentence about ~rtf."""
    assert options.options_of({}).real_time_factor is None and options.options_of({"rtf": 0}).real_time_factor == 0.0


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"base_watchdog_timeout": "x"}, "~base_watchdog_timeout must be a number of seconds, 0 for none, not 'x'"),
        ({"base_watchdog_timeout": True}, "~base_watchdog_timeout must be a number of seconds"),
        ({"base_watchdog_timeout": math.nan}, "~base_watchdog_timeout must be a number of seconds"),
        ({"base_watchdog_timeout": [0.2]}, "~base_watchdog_timeout must be a number of seconds"),
        ({"rtf": -1.0}, "~rtf must be a number from 0 to 100, not -1.0"),
        ({"rtf": "fast"}, "~rtf must be a number from 0 to 100, not 'fast'"),
        ({"robots": 1.5}, "~robots must be a whole number >= 0, not 1.5"),
        ({"seed": -1}, "~seed must be a whole number >= 0, not -1"),
        ({"odometry": "gps"}, "~odometry must be bias or random_walk, not 'gps'"),
        ({"odometry": ["bias"]}, "~odometry must be bias or random_walk"),
    ],
)
def test_bad_parameters_are_named(parameters, message):
    with pytest.raises(OptionError) as error:
        options.options_of(parameters)
    assert message in str(error.value)


def test_one_warning_names_all_that_does_nothing():
    arguments = options.read_arguments(["--clock", "a.world"])
    given = ["is_depth_canonical", "seed", "base_watchdog_timout"]
    assert options.warning_of(given, arguments) == (
        "without effect here: parameters ~is_depth_canonical; arguments --clock; "
        "parameter base_watchdog_timout is unknown, is base_watchdog_timeout meant?"
    )
    assert options.warning_of(options.PARAMETERS, options.read_arguments(["-g", "a.world"])) == ""


@pytest.mark.parametrize(
    ("names", "use_model_names", "expected"),
    [
        (["anna"], False, [("", "")]),
        (["anna"], True, [("/anna/", "anna/")]),
        (["anna", "bob"], False, [("/robot_0/", "robot_0/"), ("/robot_1/", "robot_1/")]),
        (["anna", "bob"], True, [("/anna/", "anna/"), ("/bob/", "bob/")]),
        (["anna", "position:0"], True, [("/anna/", "anna/"), ("/robot_1/", "robot_1/")]),
        (["my robot"], False, [("", "")]),
    ],
)
def test_prefixes_are_those_of_stageros(names, use_model_names, expected):
    assert options.prefixes(names, use_model_names) == [Prefixes(*pair) for pair in expected]


def test_a_name_that_no_topic_can_have_is_told():
    with pytest.raises(OptionError, match='-u: "my robot" is no name for topics'):
        options.prefixes(["my robot"], True)
