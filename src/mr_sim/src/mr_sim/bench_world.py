"""How fast the world is alone: robots that wander and scan, no ROS, one process on one core."""

import argparse
import json
import statistics
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from mr_sim.world import World
from mr_sim.world_description import WorldDescription
from mr_sim.world_model import load_world
from mr_sim.worlds import find_world

# What Stage reached through stageros on a 2-core machine, by number of robots.
BARS = {1: 157.0, 2: 102.0, 3: 79.0, 4: 54.0}
TURN_STEPS = 20  # steps a blocked robot turns before it drives on


@dataclass(frozen=True)
class Row:
    """One line of a benchmark: `holds` says whether `value` reaches `bar`."""

    what: str
    bar: float
    value: float
    unit: str
    holds: bool
    detail: str


def wander(world: World, seconds: float, seed: int) -> int:
    """Let all robots drive about for simulated seconds; returns the number of beams cast."""
    generator = np.random.default_rng(seed)
    turning = np.zeros(len(world.names), dtype=int)
    turn_rate = np.zeros(len(world.names))
    beams = 0
    for _ in range(round(seconds / world.interval)):
        for robot in range(len(world.names)):
            speed, turn = (0.0, turn_rate[robot]) if turning[robot] else (0.4, 0.1)
            world.command(robot, speed, turn)
        world.step()
        blocked = world.states()["stalled"] == 1
        turning = np.where(blocked, TURN_STEPS, np.maximum(turning - 1, 0))
        turn_rate = np.where(blocked, generator.choice([-1.2, 1.2], size=blocked.shape), turn_rate)
        beams += sum(len(scan.ranges) for scan in world.due_scans())
    return beams


def measure(description: WorldDescription, robots: int, seconds: float, seed: int) -> tuple[float, float, int]:
    """Simulated over CPU seconds, simulated over wall seconds, beams cast."""
    world = World(description, robots, seed)
    cpu, wall = time.process_time(), time.perf_counter()
    beams = wander(world, seconds, seed)
    return seconds / (time.process_time() - cpu), seconds / (time.perf_counter() - wall), beams


def rows(description: WorldDescription, seconds: float, runs: int) -> list[Row]:
    """One row per number of robots, the median of the runs."""
    result = []
    for robots, bar in BARS.items():
        outcomes = [measure(description, robots, seconds, seed) for seed in range(runs)]
        factors = [cpu for cpu, _, _ in outcomes]
        value = statistics.median(factors)
        result.append(
            Row(
                what=f"world alone, {robots} robot{'s' if robots > 1 else ''} with 541-beam lasers at 10 Hz",
                bar=bar,
                value=round(value, 1),
                unit="x real time per core",
                holds=value >= bar,
                detail=f"{description.path.stem}, {seconds:g} s simulated, seeds 0 to {runs - 1}: "
                f"{min(factors):.0f} to {max(factors):.0f} by CPU time, "
                f"median {statistics.median(wall for _, wall, _ in outcomes):.0f} by wall time, {outcomes[0][2]} beams",
            )
        )
    return result


def main(argv: list[str] | None = None) -> int:
    """Print the table, write the rows if asked; returns 0 when every bar holds."""
    parser = argparse.ArgumentParser(prog="bench_world", description="Speed of the world engine without ROS.")
    parser.add_argument("--world", default="office26x15", help="world to run (default: %(default)s)")
    parser.add_argument("--seconds", type=float, default=120.0, help="simulated seconds per run (default: %(default)s)")
    parser.add_argument("--runs", type=int, default=5, help="runs per number of robots (default: %(default)s)")
    parser.add_argument("--out", help="JSON file to write the rows to")
    arguments = parser.parse_args(argv)
    try:
        table = rows(load_world(find_world(arguments.world)), arguments.seconds, arguments.runs)
    except ValueError as error:
        print(f"bench_world: {error}", file=sys.stderr)
        return 1
    for row in table:
        print(f"{row.what:56} {row.value:7.1f} {row.unit} (bar {row.bar:g}: {'holds' if row.holds else 'MISSED'})")
        print(f"    {row.detail}")
    if arguments.out:
        Path(arguments.out).parent.mkdir(parents=True, exist_ok=True)
        Path(arguments.out).write_text(json.dumps([asdict(row) for row in table], indent=1) + "\n", encoding="utf-8")
    return 0 if all(row.holds for row in table) else 1


if __name__ == "__main__":
    sys.exit(main())
