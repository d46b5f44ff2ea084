"""Shares with confidence intervals, the strata of shared wall, and the rows that a benchmark writes."""

from typing import Any, Dict, List, NamedTuple, Sequence, Tuple

from .outcome import Outcome, counts

STRATA: Dict[str, Tuple[float, float]] = {"< 12 m": (0.0, 12.0), "12 to 25 m": (12.0, 25.0), ">= 25 m": (25.0, 1e9)}
"""Shared wall in metres, from and below."""
_CONFIDENCE = 0.95

Row = Dict[str, Any]


class Trial(NamedTuple):
    """One pair, answered by every rule."""

    seed: int
    family: str
    shared: float
    alias: bool
    drift: float
    outcomes: Dict[str, Outcome]

    @property
    def stratum(self) -> str:
        """The stratum of its shared wall, or "self-alias"."""
        if self.alias:
            return "self-alias"
        return next(name for name, (least, most) in STRATA.items() if least <= self.shared < most)


def interval(successes: int, trials: int) -> Tuple[float, float]:
    """Bounds of a share at 95 % (Clopper and Pearson 1934); 0 to 1 without trials. For none in n trials only the upper
    bound is of use; it is then the one-sided one, about 3 / n."""
    if trials == 0:
        return 0.0, 1.0
    from scipy.stats import beta  # here, for missions, which take the strata alone: it is slow to import

    tail = 1.0 - _CONFIDENCE
    if successes == 0:
        return 0.0, float(beta.ppf(_CONFIDENCE, 1, trials))
    low = float(beta.ppf(tail / 2, successes, trials - successes + 1))
    high = 1.0 if successes == trials else float(beta.ppf(1 - tail / 2, successes + 1, trials - successes))
    return low, high


def share_row(what: str, trials: Sequence[Trial], rule: str, least: float, command: str) -> Row:
    """Row for the share of right answers in per cent, with its interval. Without trials it does not hold."""
    number = counts(trial.outcomes[rule] for trial in trials)
    low, high = interval(number["right"], len(trials))
    share = 100.0 * number["right"] / max(1, len(trials))
    return row(
        what,
        f">= {least:g}",
        round(share, 1),
        "%",
        bool(trials) and share >= least,
        f"95 %: {100 * low:.1f} to {100 * high:.1f}; {number}, {len(trials)} pairs; {command}",
    )


def wrong_row(what: str, trials: Sequence[Trial], rule: str, command: str) -> Row:
    """Row for wrong answers, with the upper bound of their share. Without trials it does not hold."""
    number = counts(trial.outcomes[rule] for trial in trials)
    seeds = [trial.seed for trial in trials if trial.outcomes[rule].kind == "wrong"]
    _, high = interval(number["wrong"], len(trials))
    detail = f"95 %: at most {100 * high:.2f} % of the pairs; {number}, {len(trials)} pairs"
    if seeds:
        detail += f"; wrong at the seeds {seeds[:20]}"
    return row(what, "= 0", number["wrong"], "pairs", bool(trials) and not seeds, f"{detail}; {command}")


def row(what: str, bar: str, value: object, unit: str, holds: bool, detail: str) -> Row:
    """One row of out/bench/*.json."""
    return {"what": what, "bar": bar, "value": value, "unit": unit, "holds": holds, "detail": detail}


def table(trials: Sequence[Trial], rules: Sequence[str]) -> List[str]:
    """Lines of a table: per stratum and rule how many answers of each kind, and the share of right ones."""
    lines = [f"{'shared wall':12s} {'rule':24s} {'pairs':>5s} right imprecise wrong declined  right, 95 %      CPU s"]
    for stratum in [*STRATA, "self-alias"]:
        chosen = [trial for trial in trials if trial.stratum == stratum]
        for rule in rules:
            outcomes = [trial.outcomes[rule] for trial in chosen]
            number = counts(outcomes)
            low, high = interval(number["right"], len(chosen))
            seconds = sum(outcome.seconds for outcome in outcomes) / max(1, len(outcomes))
            lines.append(
                f"{stratum:12s} {rule:24s} {len(chosen):5d} {number['right']:5d} {number['imprecise']:9d} "
                f"{number['wrong']:5d} {number['declined']:8d}  {100 * low:5.1f} to {100 * high:5.1f} %  {seconds:6.3f}"
            )
    return lines
