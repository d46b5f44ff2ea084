"""Parameters that were set and that nobody reads: misspelt ones would be passed over without a word."""

import difflib
from typing import Iterable, List


def unknown_parameters(given: Iterable[str], known: Iterable[str]) -> List[str]:
    """One line for each name that is given and not known."""
    names, lines = sorted(known), []
    for name in sorted(set(given) - set(names)):
        near = difflib.get_close_matches(name, names, 1)
        lines.append(f"parameter {name} is unknown" + (f", is {near[0]} meant?" if near else ""))
    return lines
