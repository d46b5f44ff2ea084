"""Statistics of trials: quantiles, bootstrap confidence intervals and verdicts on paired differences."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from typing import Sequence

import numpy as np
from scipy import stats

CONFIDENCE = 0.95
RESAMPLES = 10_000
SEED = 1
MINIMUM_PAIRS = 6  # with fewer, even differences of one sign are no evidence at 95 %: 2 * 0.5**5 > 0.05


@dataclass(frozen=True)
class Interval:
    low: float
    high: float


@dataclass(frozen=True)
class Summary:
    """Of `count` values."""

    count: int
    low: float  # 0.05 quantile
    mean: float
    high: float  # 0.95 quantile
    median: float


@dataclass(frozen=True)
class Ratio:
    """Of two groups of missions, with its confidence interval."""

    value: float
    interval: Interval


class Verdict(Enum):
    BETTER = "better"
    WORSE = "worse"
    NOT_SHOWN = "no difference shown"
    TOO_FEW = "too few pairs"


@dataclass(frozen=True)
class Difference:
    """Paired differences, candidate minus baseline: their number, their mean, its interval and what follows."""

    pairs: int
    mean: float | None
    interval: Interval | None
    verdict: Verdict

    @property
    def verdict_text(self) -> str:
        missing = f" ({self.pairs} of {MINIMUM_PAIRS})" if self.verdict is Verdict.TOO_FEW else ""
        return f"{self.verdict.value}{missing}"


def summarise(values: Sequence[float]) -> Summary | None:
    """None for no values."""
    if not len(values):
        return None
    data = np.asarray(values, dtype=float)
    low, median, high = np.quantile(data, (0.05, 0.5, 0.95))
    return Summary(len(data), float(low), float(data.mean()), float(high), float(median))


def mean_interval(values: Sequence[float] | np.ndarray) -> Interval | None:
    """Bootstrap confidence interval of the mean of independent values (N,); None for fewer than two.

    The same values give the same interval. It is the percentile interval, expanded so that it holds its level for few
    values, too: T. C. Hesterberg, What Teachers Should Know About the Bootstrap, The American Statistician 69 (2015).
    """
    data = np.asarray(values, dtype=float)
    if data.size < 2:
        return None
    generator = np.random.default_rng(SEED)
    means = data[generator.integers(0, data.size, (RESAMPLES, data.size))].mean(axis=1)
    tail = _expanded_tail(data.size)
    low, high = np.quantile(means, (tail, 1.0 - tail))
    return Interval(float(low), float(high))


def _expanded_tail(count: int) -> float:
    """Share of the bootstrap distribution to cut at either end."""
    student = stats.t.ppf(0.5 + CONFIDENCE / 2.0, count - 1)
    return float(stats.norm.cdf(-math.sqrt(count / (count - 1)) * student))


def mean_ratio(numerator: Sequence[float], denominator: Sequence[float]) -> Ratio | None:
    """Ratio of the geometric means of independent positive values (N,), (M,), with the interval of Welch's test on
    their logarithms, which holds its level for few values and unequal scatter; None for fewer than two in a group."""
    groups = [np.log(np.asarray(values, dtype=float)) for values in (numerator, denominator)]
    if min(group.size for group in groups) < 2:
        return None
    centre = float(groups[0].mean() - groups[1].mean())
    parts = [float(group.var(ddof=1)) / group.size for group in groups]
    variance = sum(parts)
    half = 0.0
    if variance > 0.0:
        freedom = variance**2 / sum(part**2 / (group.size - 1) for part, group in zip(parts, groups))
        half = float(stats.t.ppf(0.5 + CONFIDENCE / 2.0, freedom)) * math.sqrt(variance)
    return Ratio(math.exp(centre), Interval(math.exp(centre - half), math.exp(centre + half)))


def median_ratio(numerator: Sequence[float], denominator: Sequence[float]) -> Ratio | None:
    """Ratio of the medians of independent positive values (N,), (M,) with its bootstrap interval, expanded as in
    `mean_interval`; None for fewer than two in a group."""
    groups = np.asarray(numerator, dtype=float), np.asarray(denominator, dtype=float)
    fewest = min(group.size for group in groups)
    if fewest < 2:
        return None
    found = stats.bootstrap(
        groups, _ratio_of_medians, n_resamples=RESAMPLES, vectorized=True, method="percentile",
        confidence_level=1.0 - 2.0 * _expanded_tail(fewest), random_state=np.random.default_rng(SEED),
    ).confidence_interval  # fmt: skip
    return Ratio(float(_ratio_of_medians(*groups)), Interval(float(found.low), float(found.high)))


def _ratio_of_medians(numerator: np.ndarray, denominator: np.ndarray, axis: int = -1) -> np.ndarray:
    return np.asarray(np.median(numerator, axis=axis) / np.median(denominator, axis=axis))


def compare_pairs(candidate: Sequence[float], baseline: Sequence[float], lower_is_better: bool) -> Difference:
    """Verdict on the candidate from values that belong together pair by pair.

    A difference is shown when the confidence interval of the mean difference excludes zero and there are MINIMUM_PAIRS.
    """
    if len(candidate) != len(baseline):
        raise ValueError(f"{len(candidate)} and {len(baseline)} values are not pairs")
    if not len(candidate):
        return Difference(0, None, None, Verdict.TOO_FEW)
    differences = np.asarray(candidate, dtype=float) - np.asarray(baseline, dtype=float)
    interval = mean_interval(differences)
    return Difference(
        len(differences), float(differences.mean()), interval, _verdict(len(differences), interval, lower_is_better)
    )


def _verdict(pairs: int, interval: Interval | None, lower_is_better: bool) -> Verdict:
    if interval is None or pairs < MINIMUM_PAIRS:
        return Verdict.TOO_FEW
    if interval.low <= 0.0 <= interval.high:
        return Verdict.NOT_SHOWN
    return Verdict.BETTER if (interval.high < 0.0) == lower_is_better else Verdict.WORSE
