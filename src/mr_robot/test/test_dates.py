"""Input that is dated ahead, by a clock or by a computer that does not keep up."""

from typing import List, Set

from mr_robot.navigation.dates import Dates

PERIOD = 0.1


def complaints(steps: List[float], ahead: float) -> Set[str]:
    """What is said of a scan dated `ahead` s ahead in each of the steps, s, after the semicolon."""
    dates, said = Dates(PERIOD), set()
    for now in steps:
        dates.step(now)
        look = dates.look("scan", now + ahead, now)
        assert look.recent == (ahead <= 0.5)
        if look.complaint is not None:
            assert look.complaint.startswith(f"scan ignored: dated {ahead:.1f} s ahead; ")
            said.add(look.complaint.partition("; ")[2])
    return said


def test_a_clock_that_is_ahead_is_told_of_when_control_comes_in_time() -> None:
    steps = [20.0 + PERIOD * step for step in range(40)]
    assert complaints(steps, 3.0) == {"its driver and this node must have one clock"}
    assert complaints(steps[:20], 3.0) == set(), "it may have been late just before"
    assert complaints(steps, 0.4) == complaints(steps, -0.4) == set()


def test_a_computer_that_does_not_keep_up_is_no_clock() -> None:
    """110 warnings of a mission asked for one clock where there was one: the node heard the time too late."""
    steps = [20.0 + (PERIOD + 0.7) * step for step in range(40)]
    assert complaints(steps, 0.9) == {"control came after 0.8 s, so this computer does not keep up"}


def test_what_is_ahead_now_and_then_is_not_complained_of() -> None:
    dates = Dates(PERIOD)
    for step in range(100):
        now = 20.0 + PERIOD * step
        dates.step(now)
        assert dates.look("pose", now + (0.8 if step % 20 else 0.0), now).complaint is None


def test_a_clock_that_was_set_back_is_told_of() -> None:
    dates = Dates(PERIOD)
    for step in range(30):
        dates.step(100.0 + PERIOD * step)
    said = []
    for step in range(40):
        now = 50.0 + PERIOD * step
        dates.step(now)
        said.append(dates.look("pose", 103.0, now).complaint)
    assert said[-1] is not None and said[-1].endswith("must have one clock")
