"""Quantiles, intervals and verdicts whose values are known or whose error rate is."""

import numpy as np
import pytest

from mr_experiments.common.statistics import (
    MINIMUM_PAIRS,
    Verdict,
    compare_pairs,
    mean_interval,
    mean_ratio,
    median_ratio,
    summarise,
)


def test_summary():
    summary = summarise(list(range(101)))
    assert (summary.count, summary.low, summary.mean, summary.median, summary.high) == (101, 5.0, 50.0, 50.0, 95.0)
    assert summarise([]) is None


def test_interval_of_the_mean():
    assert mean_interval([3.0]) is None
    constant = mean_interval([3.0] * 5)
    assert (constant.low, constant.high) == (3.0, 3.0)
    values = np.random.default_rng(3).normal(10.0, 2.0, 400)
    interval = mean_interval(values)
    expected = 1.96 * values.std(ddof=1) / 20.0
    assert interval.low == pytest.approx(values.mean() - expected, abs=0.03)
    assert interval.high == pytest.approx(values.mean() + expected, abs=0.03)
    assert interval == mean_interval(values)


def test_interval_holds_its_level_for_few_values():
    generator = np.random.default_rng(5)
    intervals = [mean_interval(generator.normal(0.0, 1.0, 8)) for _ in range(300)]
    held = sum(interval.low <= 0.0 <= interval.high for interval in intervals)
    assert 0.91 <= held / 300 <= 0.99


def test_verdicts():
    generator = np.random.default_rng(7)
    baseline = generator.normal(200.0, 30.0, 20)
    noise = generator.normal(0.0, 5.0, 20)
    assert compare_pairs(baseline - 20.0 + noise, baseline, lower_is_better=True).verdict is Verdict.BETTER
    assert compare_pairs(baseline - 20.0 + noise, baseline, lower_is_better=False).verdict is Verdict.WORSE
    assert compare_pairs(baseline + 20.0 + noise, baseline, lower_is_better=True).verdict is Verdict.WORSE
    assert compare_pairs(baseline, baseline, lower_is_better=True).verdict is Verdict.NOT_SHOWN


def test_the_difference_is_that_of_the_pairs():
    difference = compare_pairs([3.0, 5.0, 10.0], [1.0, 1.0, 1.0], lower_is_better=True)
    assert difference.pairs == 3
    assert difference.mean == 5.0
    assert difference.interval.low <= 5.0 <= difference.interval.high
    with pytest.raises(ValueError, match="not pairs"):
        compare_pairs([1.0], [1.0, 2.0], lower_is_better=True)


def test_few_pairs_show_nothing():
    few, enough = MINIMUM_PAIRS - 1, MINIMUM_PAIRS
    too_few = compare_pairs([1.0] * few, [2.0] * few, lower_is_better=True)
    assert too_few.interval.high < 0.0 and too_few.verdict is Verdict.TOO_FEW
    assert too_few.verdict_text == "too few pairs (5 of 6)"
    assert compare_pairs([1.0] * enough, [2.0] * enough, lower_is_better=True).verdict is Verdict.BETTER
    assert compare_pairs([1.0] * enough, [1.0] * enough, True).verdict_text == "no difference shown"
    assert compare_pairs([], [], lower_is_better=True).verdict is Verdict.TOO_FEW


def test_equal_sets_rarely_differ():
    generator = np.random.default_rng(11)
    verdicts = [
        compare_pairs(generator.normal(size=10), generator.normal(size=10), lower_is_better=True).verdict
        for _ in range(300)
    ]
    assert sum(verdict is not Verdict.NOT_SHOWN for verdict in verdicts) / 300 <= 0.08


def test_ratio_of_constants_and_of_too_few():
    for ratio_of in (mean_ratio, median_ratio):
        assert ratio_of([3.0], [2.0, 2.0]) is None and ratio_of([3.0, 3.0], [2.0]) is None
        ratio = ratio_of([3.0] * 4, [2.0] * 3)
        assert (ratio.value, ratio.interval.low, ratio.interval.high) == pytest.approx((1.5, 1.5, 1.5))


def test_ratio_of_medians_repeats_and_holds_them():
    generator = np.random.default_rng(3)
    above, below = generator.uniform(110.0, 130.0, 20), generator.uniform(90.0, 110.0, 12)
    ratio = median_ratio(above, below)
    assert ratio == median_ratio(above, below)
    assert ratio.value == pytest.approx(np.median(above) / np.median(below))
    assert 1.0 < ratio.interval.low < ratio.value < ratio.interval.high < 1.4


@pytest.mark.parametrize("ratio_of, runs", [(mean_ratio, 400), (median_ratio, 40)])
def test_interval_of_a_ratio_holds_its_level_for_few_values_of_unequal_scatter(ratio_of, runs):
    generator = np.random.default_rng(7)
    held = 0
    for _ in range(runs):
        above, below = (np.exp(sd * generator.standard_normal(n)) for sd, n in ((0.2, 20), (0.1, 12)))
        interval = ratio_of(above, below).interval
        held += interval.low <= 1.0 <= interval.high
    assert 0.92 * runs <= held <= 0.99 * runs + 1
