"""Seeded missions of many kinds whose outcome is stored: what changes the behaviour of robots shows as a difference.

Those in small worlds end by themselves, the others are cut at a limit, and what they have come to by then counts.
After a change that is wanted, `test_guard.py --store` runs them and stores the new outcome.
"""

import argparse
import contextlib
import json
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

from made_missions import made_mission, made_robot

from mr_experiments.bench.rows import exit_code, printed, row_of, write_rows
from mr_experiments.common.plain_rounding import plain_environment
from mr_experiments.sweep.record import own_versions
from mr_experiments.sweep.sweep import LocalPool, default_jobs
from mr_experiments.sweep.trial_process import record_path
from mr_experiments.trial.radio_options import RadioOptions
from mr_experiments.trial.trial import Trial
from mr_measures.record.files import read_record
from mr_measures.record.robot_record import Contacts, MapFigures
from mr_measures.record.series import TeamSeries

TABLE = Path(__file__).with_name("guard.json")
BAR = 120.0  # s of processor time
STORE = "/usr/bin/python3 test_guard.py --store"
WEAK = RadioOptions(range=5.0, loss=0.1, wall_attenuation=10.0)


def trial(world, robots, strategy, scenario="guard", limit=300.0, **options):
    return Trial(world, robots, 1, scenario=scenario, strategy=strategy, limit=limit, **options)


TRIALS = [
    trial("small8x8", 1, 7),
    trial("small8x8", 1, 1),
    trial("small8x8", 2, 7),
    trial("small8x8", 2, 1),
    trial("small8x8", 1, 7, "walk", odometry="random_walk"),
    trial("small8x8", 2, 1, "walk", odometry="random_walk"),
    trial("generated:cave:7001:18x12", 2, 7),
    trial("generated:cave:7001:18x12", 3, 1, "loss", radio=RadioOptions(loss=0.3)),
    trial("generated:hall:7003:18x12", 1, 7, "walk", odometry="random_walk"),
    trial("generated:office:7002:18x12", 3, 1, limit=60.0),
    trial("narrow", 2, 1, limit=60.0),
    trial("narrow", 3, 7, limit=60.0),
    trial("equalrooms26x15", 2, 7, limit=60.0),
    trial("office26x15", 3, 7, limit=60.0),
    trial("office26x15", 3, 1, "weak", 60.0, radio=WEAK),
    trial("office26x15", 3, 7, "death", 60.0, deaths={1: 20.0}),
    trial("office26x15", 3, 7, "centralized", 45.0, topology="centralized", base=(0.5, 13.8)),
    trial("office26x15_turtlebots", 1, 7, limit=90.0),
    trial("office26x15_turtlebots", 2, 1, "walk", 60.0, odometry="random_walk"),
    trial("office26x15_mixed", 2, 7, limit=60.0),
    trial("office26x15", 1, 1, "fast", fast=True),
    trial("office26x15", 3, 7, "fast", fast=True),
]
# Missions are the same bit for bit on every x86-64 processor. Others round sines and fused multiplications otherwise in
# the last bit. As long as this changes no decision, a path differs by less than a millimetre and a few cells of a map
# flip; a time may fall into the next step of the world. What is counted stays.
TOLERANCES = {
    "exploration time, s": 0.1,
    "distance, m": 0.01,
    "map error, %": 0.05,
    "known, m2": 0.1,
    "worst wrong walls": 0.002,
}


def outcome_of(record):
    """One row of the table. Of the whole team, where nothing else is said."""
    robots, outcome, known = record.robots.values(), record.outcome, record.team.series.explored
    merges = [merge for robot in robots for merge in robot.merges]
    walls = [robot.map.wrong_walls for robot in robots]
    return {
        # Where robots drive to when a mission is cut is rounded, which may turn out otherwise on another processor.
        "status": outcome.status + (f" ({outcome.reason})" if record.failed else ""),
        "exploration time, s": record.team.exploration_time,
        "distance, m": round(record.distance, 3),
        "map error, %": max(record.map_errors, key=abs, default=None),
        "known, m2": round(known[-1], 3) if known else None,
        "worst wrong walls": max((share for share in walls if share is not None), default=None),
        "collisions": sum(robot.collisions.total for robot in robots),
        "frames": sum(robot.sent("frames_sent") for robot in robots),
        "goals": sum(robot.counters["goals"] for robot in robots),
        "merges": len(merges),
        "wrong merges": sum(not merge.right for merge in merges),
    }


@contextlib.contextmanager
def working_in(folder):
    """Generated worlds are written below the working folder, and what lies beside them there would count."""
    before = os.getcwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def run_all():
    """The table and what it depends on, of a process that rounds plainly and has no threads yet."""
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / TABLE.name
        subprocess.run([sys.executable, __file__, "--write", str(path)], env=plain_environment(), check=True)
        return json.loads(path.read_text())


def measured_run():
    """What `run_all` gives, and the processor time of all processes that it takes, in s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    table = run_all()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return table, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def row_of_time(seconds, changed):
    """A row as the benchmarks'. `changed`: trials that ended otherwise than stored."""
    told = f"{changed} of them not as stored" if changed else "all as stored"
    return row_of(f"guard, {len(TRIALS)} trials", f"<= {BAR:g}", round(seconds, 1), "s", seconds <= BAR, told)


def run_here():
    with tempfile.TemporaryDirectory() as name, working_in(name):
        folder = Path(name) / "records"
        folder.mkdir()
        list(LocalPool(min(2, default_jobs())).run(TRIALS, folder))
        records = {trial.key: read_record(record_path(folder, trial)) for trial in TRIALS}
    libraries = {name: version for name, version in own_versions().items() if name != "code"}
    return {"versions": libraries, "trials": {key: outcome_of(record) for key, record in records.items()}}


def same(figure, before, after):
    if isinstance(before, float) and isinstance(after, float):
        return abs(after - before) <= TOLERANCES[figure] + 1e-9
    return before == after


def changes(before, after):
    """(trial, figure, value before, value after) of what is not as stored."""
    for key in [*before["trials"], *(key for key in after["trials"] if key not in before["trials"])]:
        old, new = before["trials"].get(key, {}), after["trials"].get(key, {})
        for figure in {**old, **new}:
            if not same(figure, old.get(figure), new.get(figure)):
                yield key, figure, old.get(figure), new.get(figure)


def differences(before, after):
    """Lines of text; none if all is as stored."""
    rows = list(changes(before, after))
    if not rows:
        return []
    lines = [f"{len(rows)} figures of {len({row[0] for row in rows})} trials have changed:", ""]
    cells = [("trial", "figure", "before", "after", "change"), *((*map(str, row), change(*row[2:])) for row in rows)]
    widths = [max(map(len, column)) for column in zip(*cells)]
    lines += ["  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in cells]
    other = [
        f"{name} {before['versions'].get(name)}, here {version}"
        for name, version in after["versions"].items()
        if before["versions"].get(name) != version
    ]
    lines += ["", f"The table was stored with other versions: {'; '.join(other)}."] if other else []
    return [*lines, "", f"If this is wanted, store the new table: cd {TABLE.parent} && {STORE}"]


def change(before, after):
    if not all(isinstance(value, (int, float)) for value in (before, after)):
        return ""
    relative = f" ({100.0 * (after / before - 1.0):+.1f} %)" if before else ""
    return f"{after - before:+g}"[:10] + relative


def test_missions_end_as_stored():
    lines = differences(json.loads(TABLE.read_text()), run_all())
    assert not lines, "\n" + "\n".join(lines)


def test_trials_are_of_many_kinds():
    assert len({trial.key for trial in TRIALS}) == len(TRIALS)
    for kind in ("robots", "strategy", "odometry", "fast", "topology", "world"):
        assert len({getattr(trial, kind) for trial in TRIALS}) > 1, kind
    assert {1, 2, 3} == {trial.robots for trial in TRIALS}
    assert any(trial.radio.loss > 0.0 for trial in TRIALS) and any(trial.deaths for trial in TRIALS)
    for world in ("turtlebots", "mixed", "generated:"):
        assert any(world in trial.world for trial in TRIALS), world


def test_what_a_cut_mission_has_come_to_counts():
    robot = made_robot(
        map=MapFigures(wrong_walls=0.01), merges=(), distance=12.0, collisions=Contacts(1, 2), counters={"goals": 4}
    )
    reason, series = "limit of 60 s reached: robot_0: drives to (1.0, 2.0)", TeamSeries((0.0, 5.0), (10.0, 83.25))
    row = outcome_of(made_mission([robot], "unfinished", 60.0, reason, series=series))
    assert (row["status"], row["known, m2"], row["worst wrong walls"]) == ("unfinished", 83.25, 0.01)
    assert (row["distance, m"], row["collisions"], row["goals"]) == (12.0, 3, 4)
    failed = made_mission([robot], "failed", 60.0, "its process ended")
    assert outcome_of(failed)["status"] == "failed (its process ended)"


def table(**figures):
    row = {"status": "finished", "exploration time, s": 50.0, "frames": 100, "goals": 7, **figures}
    return {"versions": {"numpy": "1"}, "trials": {"a-trial": row}}


def test_difference_is_readable():
    lines = differences(table(), table(frames=120, **{"exploration time, s": 55.5}))
    assert lines[0] == "2 figures of 1 trials have changed:"
    assert [line.split("  ")[0] for line in lines[3:5]] == ["a-trial", "a-trial"]
    assert " ".join(lines[3].split()) == "a-trial exploration time, s 50.0 55.5 +5.5 (+11.0 %)"
    assert " ".join(lines[4].split()) == "a-trial frames 100 120 +20 (+20.0 %)"
    assert lines[-1].endswith("test_guard.py --store")


def test_unfinished_and_new_trials_are_differences():
    lost = differences(table(), table(status="unfinished (limit)", **{"exploration time, s": None}))
    assert any(" ".join(line.split()) == "a-trial exploration time, s 50.0 None" for line in lost)
    more = table()
    more["trials"]["b-trial"] = {"goals": 1}
    assert any("b-trial" in line for line in differences(table(), more))
    assert any("b-trial" in line for line in differences(more, table()))


def test_only_rounding_is_tolerated():
    assert differences(table(), table(**{"exploration time, s": 50.1})) == []
    assert differences(table(), table(**{"exploration time, s": 50.2}))
    assert differences(table(), table(goals=8))


def test_other_versions_are_told():
    other = {**table(goals=8), "versions": {"numpy": "2"}}
    assert "The table was stored with other versions: numpy 1, here 2." in differences(table(), other)
    assert differences(table(), {**table(), "versions": {"numpy": "2"}}) == []


def test_its_time_is_a_row_of_a_benchmark():
    row = row_of_time(76.04, 0)
    assert (row["what"], row["bar"], row["value"], row["unit"]) == ("guard, 22 trials", "<= 120", 76.0, "s")
    assert row["holds"] and row["detail"] == "all as stored"
    assert not row_of_time(120.1, 0)["holds"] and row_of_time(1.0, 2)["detail"] == "2 of them not as stored"


def main():
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0], epilog="Exit code: 0 all as stored, 1 something changed or took too long."
    )
    parser.add_argument("--store", action="store_true", help=f"store the outcome in {TABLE.name}")
    parser.add_argument("--out", type=Path, metavar="FILE", help="JSON file to write the row of its processor time to")
    parser.add_argument("--write", type=Path, help="only run the trials and write their outcome to this file")
    arguments = parser.parse_args()
    if arguments.write:
        arguments.write.write_text(json.dumps(run_here()))
        return 0
    now, seconds = measured_run()
    before = json.loads(TABLE.read_text()) if TABLE.exists() else {"versions": {}, "trials": {}}
    lines = differences(before, now)
    print("\n".join(lines) or "All as stored.")
    row = printed(row_of_time(seconds, len({key for key, *_ in changes(before, now)})))
    if arguments.out:
        write_rows([row], arguments.out)
    if arguments.store:
        TABLE.write_text(json.dumps(now, indent=2) + "\n")
        print(f"Stored in {TABLE}.")
        return 0
    return 1 if lines else exit_code([row])


if __name__ == "__main__":
    sys.exit(main())
