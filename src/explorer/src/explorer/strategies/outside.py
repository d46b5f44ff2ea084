"""Strategies that are not part of this package: classes in modules or files of the user's own, named by their place."""

import os
import sys
from typing import NoReturn, Type

from explorer.strategies.strategy import REGISTRY, Strategy, registered
from mr_grid.by_place import PlaceError, names_a_place, object_at

VARIABLE = "EXPLORER_STRATEGIES"
"""Environment variable with places of strategies, separated by blanks. They are there in every program that knows the
strategies by number: the node, the team runner, missions in virtual time."""

NEEDED = ("number", "name", "title", "allocation")


def strategy_at(place: str) -> Type[Strategy]:
    """The class at `module:Class` or `path/file.py:Class`, registered. KeyError with what is wrong there."""
    try:
        found = object_at(place)
    except PlaceError as error:
        raise KeyError(f"strategy {error}") from error
    if not (isinstance(found, type) and issubclass(found, Strategy)):
        raise KeyError(f"strategy {place!r}: that is no class of a Strategy")
    missing = [attribute for attribute in NEEDED if not hasattr(found, attribute)]
    if missing:
        raise KeyError(f"strategy {place!r}: the class has no {', '.join(missing)}")
    if REGISTRY.get(found.number) is not found:
        try:
            registered(found)
        except ValueError as error:
            raise KeyError(f"strategy {place!r}: {error}") from error
    return found


def strategies_of_environment() -> None:
    """Registers what the environment variable names. What cannot be used ends the program with one line and exit code
    2, as bad options do."""
    for place in os.environ.get(VARIABLE, "").split():
        if not names_a_place(place):
            _end(f"{place!r} is not of the form module:Class or path/file.py:Class")
        try:
            strategy_at(place)
        except KeyError as error:
            _end(error.args[0])


def _end(reason: str) -> NoReturn:
    print(f"{VARIABLE}: {reason}; correct or unset this variable of the environment", file=sys.stderr)
    raise SystemExit(2)
