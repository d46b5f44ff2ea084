"""Measures registration on generated pairs of maps with known truth; exit code 1 if one that has no copy was wrong."""

import argparse

from ..benchmark.figures import table
from ..benchmark.report import ALONE, family_table, trial_of_seed
from ..benchmark.rules import RULES

FIRST_SEED = 500_000
"""The method was tuned on some of those below."""


def run(options: argparse.Namespace) -> int:
    """Prints a table by family and one by shared wall."""
    trials = [trial_of_seed(seed) for seed in range(FIRST_SEED, FIRST_SEED + options.pairs)]
    print("\n".join([*family_table(trials), "", *table(trials, list(RULES))]))
    return int(any(trial.outcomes[ALONE].kind == "wrong" for trial in trials if not trial.alias))
