"""The table of the other robots."""

from explorer.team import MAXIMUM_ROBOTS, Team


def test_of_more_robots_than_there_is_room_for_the_others_do_not_come_again_and_again() -> None:
    """Each time all frontiers were told anew: twenty times the messages."""
    team = Team("own", 10.0)
    names = [f"robot_{number:03d}" for number in range(MAXIMUM_ROBOTS + 5)]
    assert len(team.set_known(names)[0]) == MAXIMUM_ROBOTS
    assert team.set_known(names) == ([], [])


def test_robots_that_have_left_make_room() -> None:
    team = Team("own", 10.0)
    for number in range(MAXIMUM_ROBOTS + 30):
        assert team.set_known([f"robot_{number}"])[0] == [f"robot_{number}"]
    assert team.known() == [f"robot_{MAXIMUM_ROBOTS + 29}"]
