"""Trials in a file, one line of JSON each, so that a benchmark that was stopped goes on where it was."""

import hashlib
import json
import math
from pathlib import Path
from typing import Any, Dict, List, Sequence

from .. import _surfaces
from .figures import Trial
from .outcome import Outcome

_PACKAGE = Path(__file__).resolve().parents[1]
_ERRORS = ("mean_error", "largest_error", "rotation_error")


def code_digest() -> str:
    """Name of this package's code as it is: trials of other code do not count."""
    digest = hashlib.sha256(Path(_surfaces.__file__).read_bytes())
    for path in sorted(_PACKAGE.rglob("*.py")):
        digest.update(path.relative_to(_PACKAGE).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


class TrialFile:
    """The trials of one code and one choice of rules, by seed. Those of another code or choice are dropped."""

    def __init__(self, path: Path, rules: Sequence[str]) -> None:
        self._path = path
        self._header = {"code": code_digest(), "rules": list(rules)}
        self.trials: Dict[int, Trial] = {}
        lines = _whole_lines(path)
        if lines and lines[0] == self._header:
            self.trials = {trial.seed: trial for trial in map(_trial_of, lines[1:])}
        path.parent.mkdir(parents=True, exist_ok=True)
        self._write([self._header, *map(_line_of, self.trials.values())], "w")

    def add(self, trial: Trial) -> None:
        """Keeps a trial; it is in the file when this returns."""
        self.trials[trial.seed] = trial
        self._write([_line_of(trial)], "a")

    def _write(self, lines: Sequence[Dict[str, Any]], mode: str) -> None:
        with open(self._path, mode, encoding="utf-8") as file:
            file.writelines(json.dumps(line, allow_nan=False) + "\n" for line in lines)


def _whole_lines(path: Path) -> List[Dict[str, Any]]:
    """All lines up to the first that was not written to its end."""
    lines: List[Dict[str, Any]] = []
    if path.exists():
        for line in path.read_text(encoding="utf-8").splitlines():
            try:
                lines.append(json.loads(line))
            except ValueError:
                break
    return lines


def _line_of(trial: Trial) -> Dict[str, Any]:
    outcomes = {rule: _finite(outcome._asdict()) for rule, outcome in trial.outcomes.items()}
    return {**trial._asdict(), "outcomes": outcomes}


def _trial_of(line: Dict[str, Any]) -> Trial:
    outcomes = {
        rule: Outcome(**{**values, **{name: _number(values[name]) for name in _ERRORS}})
        for rule, values in line["outcomes"].items()
    }
    return Trial(**{**line, "outcomes": outcomes})


def _finite(values: Dict[str, Any]) -> Dict[str, Any]:
    """JSON knows no infinity: the errors of a pair that was declined are null."""
    return {**values, **{name: values[name] if math.isfinite(values[name]) else None for name in _ERRORS}}


def _number(value: Any) -> float:
    return math.inf if value is None else float(value)
