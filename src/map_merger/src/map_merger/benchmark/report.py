"""The rows of the registration benchmark."""

from pathlib import Path
from typing import Iterator, List, Sequence

import cv2
import numpy as np

from .families import Case, draw_case
from .figures import Row, Trial, row, share_row, wrong_row
from .real_logs import cases_of, logs_of
from .rules import RULES, measured
from .timing import Times, floor_pairs, large_pair, times_of

ALONE, PRIOR, SURE, AGENTS, WALLS = BY_WALLS = list(RULES)[:5]
"""The rules that this package answers by; the others are features, for comparison."""


def trial_of(case: Case, rules: Sequence[str] = tuple(RULES)) -> Trial:
    """The case answered by those rules."""
    cv2.setRNGSeed(case.seed)
    outcomes = {name: measured(RULES[name], case) for name in rules}
    return Trial(case.seed, case.family, case.shared, case.alias, case.drift, outcomes)


def trial_of_seed(seed: int, rules: Sequence[str] = tuple(RULES)) -> Trial:
    """One synthetic pair, drawn and answered: a job for a process of its own."""
    cv2.setNumThreads(1)
    return trial_of(draw_case(seed), rules)


def trials_of_logs(folder: Path, seed: int, count: int) -> Iterator[Trial]:
    """`count` pairs of pieces of each log in the folder."""
    for number, log in enumerate(logs_of(folder)):
        yield from (trial_of(case) for case in cases_of(log, seed + 10_000 * number, count))


def synthetic_rows(trials: Sequence[Trial], command: str) -> List[Row]:
    """Rows of the bars of generated pairs, and of features beside them."""
    plain = [trial for trial in trials if not trial.alias]
    aliases = [trial for trial in trials if trial.alias]
    long = [trial for trial in plain if trial.shared >= 25.0]
    short = [trial for trial in plain if 12.0 <= trial.shared < 25.0]
    rows = [
        share_row("right, >= 25 m shared wall, two maps alone", long, ALONE, 97.0, command),
        share_row("right, 12 to 25 m shared wall, two maps alone", short, ALONE, 60.0, command),
        share_row("right, 12 to 25 m shared wall, rough prior", short, PRIOR, 95.0, command),
        wrong_row("wrong, two maps alone", plain, ALONE, command),
        wrong_row("wrong, rough prior", plain, PRIOR, command),
        reported(wrong_row("wrong, two maps alone, self-alias", aliases, ALONE, command)),
        reported(wrong_row("wrong, rough prior, self-alias", aliases, PRIOR, command)),
        wrong_row("wrong, two maps alone, sure, all pairs", trials, SURE, command),
        reported(share_row("right, >= 25 m shared wall, two maps alone, sure", long, SURE, 0.0, command)),
        wrong_row("wrong, agents without sighting, all pairs", trials, AGENTS, command),
    ]
    rows.append(wrong_row("wrong, agents by walls alone, all pairs", trials, WALLS, command))
    symmetric = [trial for trial in trials if trial.family.startswith("symmetric")]
    rows.append(wrong_row("wrong, agents without sighting, symmetric building", symmetric, AGENTS, command))
    return rows


def reported(bare: Row) -> Row:
    """The row without a bar: no rule can tell an exact copy of a place from the place itself by two maps alone."""
    return {**bare, "bar": "reported", "holds": True}


def real_rows(trials: Sequence[Trial], command: str) -> List[Row]:
    """Rows of the bars of real logs."""
    long = [trial for trial in trials if trial.shared >= 25.0]
    return [
        share_row("right, real logs, >= 25 m shared wall, two maps alone", long, ALONE, 90.0, command),
        wrong_row("wrong, real logs, two maps alone", trials, ALONE, command),
        wrong_row("wrong, real logs, two maps alone, sure", trials, SURE, command),
        wrong_row("wrong, real logs, agents without sighting", trials, AGENTS, command),
    ]


def timing_rows(seed: int, command: str) -> List[Row]:
    """Rows of the CPU time of a registration."""
    floor, large = times_of(floor_pairs(seed, 40)), times_of([large_pair(seed)] * 3)
    median, most = float(np.median(floor.registration)), max(floor.registration)
    slow = float(np.median(large.registration))
    what = "CPU time of a registration, one core"
    return [
        row(f"{what}, 26 m x 15 m, median", "<= 0.15", round(median, 3), "s", median <= 0.15, _detail(floor, command)),
        row(f"{what}, 26 m x 15 m, largest", "<= 0.4", round(most, 3), "s", most <= 0.4, _detail(floor, command)),
        row(f"{what}, 2000 x 2000 cells", "<= 1.2", round(slow, 3), "s", slow <= 1.2, _detail(large, command)),
    ]


def _detail(times: Times, command: str) -> str:
    share = float(np.median(times.landmarks))
    return f"{len(times.registration)} pairs; landmarks of both maps {share:.3f} s more; {command}"


def family_table(trials: Sequence[Trial], rules: Sequence[str] = tuple(RULES)) -> List[str]:
    """Lines of a table: per family how many answers of each kind the two maps alone gave, and how many wrong ones the
    other rules."""
    lines = [f"{'family':34s} pairs alias  right imprecise wrong declined   wrong: {', '.join(rules[1:])}"]
    for name in dict.fromkeys(trial.family for trial in trials):
        chosen = [trial for trial in trials if trial.family == name]
        alone = [trial.outcomes[ALONE].kind for trial in chosen]
        wrong = [sum(trial.outcomes[rule].kind == "wrong" for trial in chosen) for rule in rules[1:]]
        lines.append(
            f"{name:34s} {len(chosen):5d} {sum(trial.alias for trial in chosen):5d}  {alone.count('right'):5d} "
            f"{alone.count('imprecise'):9d} {alone.count('wrong'):5d} {alone.count('declined'):8d}   {wrong}"
        )
    return lines
