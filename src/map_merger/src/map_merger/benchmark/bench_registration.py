"""Benchmark of map registration: prints tables and writes rows {what, bar, value, unit, holds, detail} as JSON."""

import argparse
import functools
import os
import sys
from pathlib import Path

# One thread per process: the processes share the cores, and CPU times are those of one core.
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
import cv2

from map_merger.benchmark import report
from map_merger.benchmark.figures import table
from map_merger.benchmark.records import TrialFile
from map_merger.benchmark.rows import conclude
from map_merger.benchmark.rules import RULES
from map_merger.benchmark.sweep import trials_of

MOST_JOBS = 2


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=560, help="generated pairs, at least 1 (default 560)")
    parser.add_argument(
        "--seed", type=int, default=500_000, help="first seed (default 500000; the method was tuned on some below)"
    )
    parser.add_argument(
        "--jobs",
        type=int,
        default=min(MOST_JOBS, os.cpu_count() or 1),
        help=f"processes (default: one per core, at most {MOST_JOBS})",
    )
    parser.add_argument("--no-features", action="store_true", help="leave out ORB and AKAZE")
    parser.add_argument("--real-logs", type=Path, metavar="DIR", help="also CARMEN logs (FLASER lines, gzip or plain)")
    parser.add_argument("--real-pairs", type=int, default=12, help="pairs of each log (default 12)")
    parser.add_argument("--no-timing", action="store_true", help="leave out the rows of CPU time")
    parser.add_argument("--verbose", action="store_true", help="one line per pair")
    parser.add_argument("--out", type=Path, default=Path("out/bench/merge.json"), help="where to write the rows")
    options = parser.parse_args()
    if options.pairs < 1 or options.jobs < 1 or options.real_pairs < 1:
        parser.error("--pairs, --jobs and --real-pairs must be at least 1")
    return options


def answered(options: argparse.Namespace, rules: list) -> list:
    """The trials of all seeds, with progress. They go into a file beside the rows, and those that are there already
    are not made again."""
    known = TrialFile(options.out.with_suffix(".trials.jsonl"), rules)
    seeds = range(options.seed, options.seed + options.pairs)
    missing = [seed for seed in seeds if seed not in known.trials]
    done = len(seeds) - len(missing)
    if done:
        print(f"goes on after {done} of {len(seeds)} pairs", file=sys.stderr)
    for trial in trials_of(missing, options.jobs, functools.partial(report.trial_of_seed, rules=rules)):
        known.add(trial)
        done += 1
        progress(trial, done, len(seeds), options.verbose)
    return [known.trials[seed] for seed in seeds]


def progress(trial: report.Trial, done: int, of: int, verbose: bool) -> None:
    if verbose:
        kinds = ", ".join(f"{rule} {outcome.kind} ({outcome.reason})" for rule, outcome in trial.outcomes.items())
        print(f"{trial.seed} {trial.family}, {trial.stratum}, {trial.shared:.1f} m: {kinds}", flush=True)
    elif done % 20 == 0 or done == of:
        print(f"\r{done} of {of} pairs", end="\n" if done == of else "", flush=True, file=sys.stderr)


def main() -> int:
    try:
        return measure(arguments())
    except (OSError, ValueError, RuntimeError) as error:
        sys.exit(f"bench_registration: {error}")
    except KeyboardInterrupt:
        sys.exit("bench_registration: interrupted; the same command goes on from here")


def measure(options: argparse.Namespace) -> int:
    cv2.setNumThreads(1)
    command = "bench_registration " + " ".join(sys.argv[1:])
    rules = report.BY_WALLS if options.no_features else list(RULES)
    # Before the pairs, so that nothing else of this benchmark runs on the machine's caches.
    rows = [] if options.no_timing else report.timing_rows(options.seed, command)
    trials = answered(options, rules)
    rows += report.synthetic_rows(trials, command)
    print("\n".join(["", *report.family_table(trials, rules), "", *table(trials, rules)]))
    if options.real_logs is not None:
        real = []
        for trial in report.trials_of_logs(options.real_logs, options.seed, options.real_pairs):
            real.append(trial)
            progress(trial, len(real), 0, options.verbose)
        rows += report.real_rows(real, command)
        print("\n".join(["", *report.family_table(real), "", *table(real, list(RULES))]))
    return conclude(rows, options.out)
