#!/usr/bin/env python3
"""How many broken set-ups the doctor names, and how often it says what is not so: `make bench-doctor`.

Each set-up of `broken_set_ups` is broken really and alone: a robot on a master of its own, mended and looked at after
each fault, and a computer in namespaces of its own, as root. Each row: {what, bar, value, unit, holds, detail}.
"""

import argparse
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Any, Dict, Iterator, List, NamedTuple, Sequence, Tuple

from broken_set_ups import COMPUTERS, DOCTOR, NO_MASTER, ROBOTS, TWO_OF_ONE_NAME, LiveRobot, examine, lines_of, told_of
from live_master import LiveMaster


class Examined(NamedTuple):
    """A set-up, the beginnings of the lines that the doctor has to say of it, and what it said. A healthy one: none."""

    what: str
    wanted: Tuple[str, ...]
    said: Tuple[str, ...]

    @property
    def named(self) -> bool:
        return all(any(line.startswith(beginning) for line in self.said) for beginning in self.wanted)

    @property
    def alarms(self) -> List[str]:
        """Lines of what was not broken."""
        return [line for line in self.said if not line.startswith(self.wanted)] if self.wanted else list(self.said)


def robots(folder: Path) -> Iterator[Examined]:
    """Each broken one, and each time the same when it was mended."""
    live = LiveRobot(folder)
    try:
        yield _healthy(live)
        for what, fault in {**ROBOTS, "two robots of one name": TWO_OF_ONE_NAME}.items():
            fault.make(live)
            done = live.run(*DOCTOR, *fault.words)
            yield Examined(what, tuple(told_of(live, [fault])), tuple(lines_of(done)))
            live.mend()
            yield _healthy(live)
    finally:
        live.close()


def _healthy(live: LiveRobot) -> Examined:
    return Examined("", (), tuple(lines_of(live.run(*DOCTOR))))


def computers(folder: Path) -> Iterator[Examined]:
    for number, (what, fault) in enumerate(COMPUTERS.items()):
        own = folder / str(number)
        own.mkdir()
        done, told = examine(own, [fault])
        yield Examined(what, tuple(told), tuple(lines_of(done)))
    ended = folder / "ended"
    ended.mkdir()
    master = LiveMaster(ended)
    master.close()
    done = master.run(*DOCTOR)
    yield Examined("a master that has ended", (NO_MASTER.rpartition(":")[0],), tuple(lines_of(done)))


def rows_of(broken: Sequence[Examined], healthy: Sequence[Examined]) -> List[Dict[str, Any]]:
    missed = [f"{one.what}: {'; '.join(one.said) or 'nothing'}" for one in broken if not one.named]
    alarms = [f"{one.what}: {line}" for one in broken for line in one.alarms]
    alarms_of_healthy = [line for one in healthy for line in one.alarms]
    names = ", ".join(one.what for one in broken)
    return [
        _row("broken set-ups named", f">= {len(broken)}", len(broken) - len(missed), "set-ups", missed,
             f"each broken alone: {names}"),
        _row("false alarms on broken set-ups", "<= 0", len(alarms), "lines", alarms, f"{len(broken)} set-ups"),
        _row("false alarms on a healthy robot", "<= 0", len(alarms_of_healthy), "lines", alarms_of_healthy,
             f"{len(healthy)} examinations, one after each fault that was mended"),
    ]  # fmt: skip


def _row(what: str, bar: str, value: int, unit: str, faults: Sequence[str], detail: str) -> Dict[str, Any]:
    """`faults`: why it misses its bar."""
    told = {"holds": not faults, "detail": "; ".join(faults) or detail}
    return {"what": f"doctor: {what}", "bar": bar, "value": value, "unit": unit, **told}


def main() -> int:
    parser = argparse.ArgumentParser(prog="bench_doctor", description=str(__doc__).split(":", maxsplit=1)[0])
    parser.add_argument("--out", default="", metavar="FILE", help="JSON file for the rows")
    options = parser.parse_args()
    if os.geteuid():
        print("bench_doctor: set-ups without rights and with raw frames need root: run it as root", file=sys.stderr)
        return 2
    examined = []
    with tempfile.TemporaryDirectory(prefix="bench_doctor-") as place:
        for kind in (robots, computers):
            folder = Path(place) / kind.__name__
            folder.mkdir()
            for one in kind(folder):
                print(f"{one.what or 'mended'}: {'; '.join(one.said) or 'nothing'}", flush=True)
                examined.append(one)
    rows = rows_of([one for one in examined if one.wanted], [one for one in examined if not one.wanted])
    for row in rows:
        print(f"{'ok  ' if row['holds'] else 'MISS'} {row['what']}: {row['value']} {row['unit']}, bar {row['bar']}")
    if options.out:
        Path(options.out).write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    return 0 if all(row["holds"] for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
