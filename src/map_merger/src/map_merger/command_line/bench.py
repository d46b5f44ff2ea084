"""Measures registration on synthetic pairs of maps with known truth."""

import argparse

from .. import benchmark, registration


def run(options: argparse.Namespace) -> int:
    """Prints a table; exit code 1 if a transform was wrong."""
    wrong = 0
    print(f"{'family':36s} right imprecise wrong declined")
    for scenario in benchmark.scenarios():
        outcomes = [
            benchmark.measure(benchmark.draw_pair(scenario, seed), seed, registration.register)
            for seed in range(1, 1 + options.pairs)
        ]
        number = benchmark.counts(outcomes)
        wrong += number["wrong"]
        print(
            f"{scenario.name:36s} {number['right']:5d} {number['imprecise']:9d} {number['wrong']:5d} "
            f"{number['declined']:8d}",
            flush=True,
        )
    return 1 if wrong else 0
