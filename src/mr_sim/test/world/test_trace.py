"""The truth trace of a robot: what the world writes, and the figures of it."""

import pytest

from mr_measures.figures import collisions, distance_driven, moving_share
from mr_measures.motion import TraceError, read_trace
from mr_sim.trace import TraceWriter


@pytest.fixture
def trace(make_world, drive, tmp_path):
    """A robot that drives 1 m in 2 s, stands 1 s, drives into a wall 1 m ahead of it, backs off and hits it again."""
    world = make_world('model ( size [ 0.2 4 1 ] pose [ 2.32 0 0 0 ] )\nrover ( name "a" )')
    path = tmp_path / "trace.csv"
    writer = TraceWriter(path, "test.world", 1, 1.0)

    def run(seconds, linear):
        for _ in range(round(seconds / world.interval)):
            drive(world, world.interval, (linear, 0.0))
            writer.write(world.time, 2 * world.time, "a", world.states()[0])

    for seconds, linear in ((2.0, 0.5), (1.0, 0.0), (3.0, 0.5), (1.0, -0.25), (1.0, 0.5)):
        run(seconds, linear)
    writer.close(world.time, 2 * world.time)
    return path


def test_a_full_disk_ends_the_trace_and_nothing_else(make_world):
    world = make_world('rover ( name "a" )')
    said = []
    writer = TraceWriter("/dev/full", "test.world", 1, 1.0, said.append)
    for step in range(1, 100):
        writer.write(float(step), float(step), "a", world.states()[0])
    writer.close(100.0, 100.0)
    assert said == ["/dev/full: No space left on device; the trace ends here"]


def test_measures_of_a_trace(trace):
    read = read_trace(trace)
    records = read.robots["a"]
    assert read.real_time_factor == pytest.approx(0.5)
    # The trace begins after the first step of 0.025 m; at 2 m the front stands against the wall's face at 2.22 m.
    assert distance_driven(records) == pytest.approx(2.0 - 0.025 + 0.25 + 0.25, abs=0.051)
    assert moving_share(records, 0.0, 3.0) == pytest.approx(40 / 60)
    assert moving_share(records, 100.0, 200.0) == 0.0
    hits = collisions(records)
    assert (hits.with_walls, hits.with_robots, hits.total) == (2, 0, 2)
    assert hits.times[0] == pytest.approx(5.0, abs=0.11) and hits.times[1] == pytest.approx(7.5, abs=0.11)


def test_trace_cut_short_by_a_crash_is_read_up_to_there(trace):
    text = trace.read_text()
    trace.write_text(text[: text.index("\n3.000,")] + "\n3.0")
    read = read_trace(trace)
    assert len(read.robots["a"]) == 59 and read.real_time_factor is None


def test_files_that_are_no_trace(tmp_path):
    path = tmp_path / "x.csv"
    path.write_text("time,x\n")
    with pytest.raises(TraceError, match="not a truth trace"):
        read_trace(path)
    path.write_text("# mr_sim trace 1 seed 0\n1,2,a,b\n")
    with pytest.raises(TraceError, match=r"x\.csv:2: not a row"):
        read_trace(path)
