"""Made-up mission records."""

from hypothesis import strategies as st

from mr_grid import Pose
from mr_measures.map_picture import Picture
from mr_measures.record.mission_record import (
    FAILED,
    FINISHED,
    UNFINISHED,
    Asked,
    Measured,
    MissionRecord,
    Note,
    Outcome,
    RobotMaps,
    Snapshot,
    Team,
)
from mr_measures.record.robot_record import Auction, Contacts, Goal, MapFigures, Merge, Offer, RobotRecord
from mr_measures.record.series import RobotSeries, TeamSeries

NAMES = ("robot_0", "robot_1", "robot_2")
numbers = st.floats(-1e6, 1e6)
times = st.floats(0.0, 1e4)
counts = st.integers(0, 10**6)
texts = st.text(max_size=8)
poses = st.builds(Pose, numbers, numbers, numbers)
pictures = st.builds(Picture, texts, st.floats(0.01, 1.0), st.tuples(numbers, numbers))


def maybe(strategy):
    return st.none() | strategy


@st.composite
def columns(draw, kind, neighbors=False):
    """Series of which some columns were not recorded."""
    moments = sorted(draw(st.lists(times, max_size=4)))
    column = st.just(()) | st.tuples(*[numbers] * len(moments))
    values = {name: draw(column) for name in kind.__dataclass_fields__ if name not in ("time", "neighbors")}
    if neighbors:
        values["neighbors"] = draw(st.just(()) | st.tuples(*[st.lists(texts, max_size=2).map(tuple)] * len(moments)))
    return kind(time=tuple(moments), **values)


merges = st.builds(Merge, texts, times, maybe(poses), maybe(numbers), maybe(numbers), texts, maybe(st.booleans()))
goals = st.builds(Goal, times, numbers, numbers, maybe(times), texts, texts, maybe(counts))
offers = st.lists(
    st.builds(Offer, numbers, numbers, st.dictionaries(texts, numbers, max_size=2), texts), max_size=2
).map(tuple)
robots = st.builds(
    RobotRecord,
    poses,
    numbers,
    numbers,
    maybe(times),
    maybe(times),
    texts,
    times,
    st.builds(Contacts, counts, counts, st.lists(times, max_size=2).map(tuple)),
    st.builds(MapFigures, maybe(counts), maybe(numbers), texts, maybe(numbers), maybe(numbers)),
    st.dictionaries(st.sampled_from(["bytes_sent", "frames_sent", "packets_failed", "hops"]), counts),
    st.dictionaries(texts, counts, max_size=2),
    st.lists(goals, max_size=2).map(tuple),
    st.lists(st.builds(Auction, times, maybe(counts), counts, counts, offers), max_size=2).map(tuple),
    maybe(st.lists(merges, max_size=2).map(tuple)),
    columns(RobotSeries, neighbors=True),
)
settings = st.fixed_dictionaries(
    {"world": st.just("flat"), "robots": st.just(2), "seed": counts, "scenario": st.just("paper"), "strategy": counts},
    optional={"limit": times, "radio": st.fixed_dictionaries({"loss": numbers}), "starts": st.just([[1.0, 2.0, 0.0]])},
)


@st.composite
def missions(draw):
    status = draw(st.sampled_from([FINISHED, UNFINISHED, FAILED]))
    team = draw(st.builds(Team, times if status == FINISHED else st.none(), maybe(numbers), columns(TeamSeries), texts))
    return MissionRecord(
        Asked(draw(settings)),
        Outcome(status, draw(times), draw(texts), draw(texts)),
        team,
        {name: draw(robots) for name in NAMES[:2]},
        draw(st.dictionaries(texts, texts, max_size=2)),
        draw(st.dictionaries(st.sampled_from(NAMES), st.builds(RobotMaps, maybe(pictures), maybe(pictures)))),
        draw(st.lists(st.builds(Snapshot.of, times, texts, pictures), max_size=2).map(tuple)),
        draw(st.lists(st.builds(Note, times, texts, texts, st.booleans()), max_size=2).map(tuple)),
        draw(
            st.builds(
                Measured,
                maybe(times),
                maybe(times),
                maybe(times),
                st.dictionaries(texts, times, max_size=2),
                texts,
                texts,
                st.dictionaries(texts, st.dictionaries(texts, times, max_size=2), max_size=2),
            )
        ),
        draw(st.dictionaries(texts, st.dictionaries(texts, counts, max_size=2), max_size=2)),
    )


def mission(**changes):
    """One of two robots that finished."""
    robot = RobotRecord(Pose(1.0, 2.0, 0.0), 30.0, 0.8, finished_at=100.0)
    asked = Asked({"world": "flat", "robots": 2, "seed": 1, "scenario": "paper", "strategy": 7})
    values = {
        "asked": asked,
        "outcome": Outcome(FINISHED, 100.0),
        "team": Team(100.0),
        "robots": {"robot_0": robot, "robot_1": robot},
    }
    return MissionRecord(**{**values, **changes})
