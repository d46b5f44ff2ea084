"""A few seeded missions whose outcome is stored: what changes the behaviour of robots shows as a difference here.

After a change that is wanted, `test_guard.py --store` runs them and stores the new outcome.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

from mr_experiments.record import versions
from mr_experiments.sweep import LocalPool, default_jobs
from mr_experiments.trial import Trial
from mr_experiments.trial_process import record_path

TABLE = Path(__file__).with_name("guard.json")
STORE = "/usr/bin/python3 test_guard.py --store"
TRIALS = [
    Trial("small8x8", robots, seed, scenario="guard", strategy=strategy, limit=300.0)
    for robots, strategy, seed in [(1, 7, 1), (1, 1, 1), (2, 7, 1), (2, 1, 1)]
]
# Missions are the same bit for bit on one type of computer. Another processor may round sines, fused multiplications
# and sums of vectors otherwise in the last bit. As long as this changes no decision, a path differs by less than a
# millimetre and a few cells of a map flip; a time may fall into the next step of the world. What is counted stays.
TOLERANCES = {
    "exploration time, s": 0.1,
    "distance, m": 0.01,
    "map error, %": 0.05,
}


def outcome_of(record):
    """One row of the table. Of the whole team, where nothing else is said."""
    robots = record["robots"].values()
    errors = [robot["map"].get("error") for robot in robots]
    merges = [merge for robot in robots for merge in robot["merges"]]
    return {
        "status": record["outcome"]["status"] + (record["outcome"]["reason"] and f" ({record['outcome']['reason']})"),
        "exploration time, s": record["team"]["exploration_time"],
        "distance, m": round(sum(robot["distance"] for robot in robots), 3),
        "map error, %": max((error for error in errors if error is not None), key=abs, default=None),
        "frames": sum(robot["radio"].get("frames_sent", 0) for robot in robots),
        "goals": sum(robot["counters"]["goals"] for robot in robots),
        "merges": len(merges),
        "wrong merges": sum(not merge["right"] for merge in merges),
    }


def run_all():
    """The table and what it depends on."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        list(LocalPool(min(2, default_jobs())).run(TRIALS, folder))
        records = {trial.key: json.loads(record_path(folder, trial).read_text()) for trial in TRIALS}
    libraries = {name: version for name, version in versions().items() if name != "code"}
    return {"versions": libraries, "trials": {key: outcome_of(record) for key, record in records.items()}}


def same(figure, before, after):
    if isinstance(before, float) and isinstance(after, float):
        return abs(after - before) <= TOLERANCES[figure] + 1e-9
    return before == after


def differences(before, after):
    """Lines of text; none if all is as stored."""
    rows = []
    for key in [*before["trials"], *(key for key in after["trials"] if key not in before["trials"])]:
        old, new = before["trials"].get(key, {}), after["trials"].get(key, {})
        rows += [
            (key, figure, old.get(figure), new.get(figure))
            for figure in {**old, **new}
            if not same(figure, old.get(figure), new.get(figure))
        ]
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


def main():
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0], epilog="Exit code: 0 all as stored, 1 something changed."
    )
    parser.add_argument("--store", action="store_true", help=f"store the outcome in {TABLE.name}")
    arguments = parser.parse_args()
    now = run_all()
    before = json.loads(TABLE.read_text()) if TABLE.exists() else {"versions": {}, "trials": {}}
    lines = differences(before, now)
    print("\n".join(lines) or "All as stored.")
    if arguments.store:
        TABLE.write_text(json.dumps(now, indent=2) + "\n")
        print(f"Stored in {TABLE}.")
        return 0
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
