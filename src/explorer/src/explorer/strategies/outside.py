"""Strategies that are not part of this package: classes in modules or files of the user's own, named by their place."""

import importlib
import importlib.util
import os
import sys
from types import ModuleType
from typing import Dict, Type

from explorer.strategies.strategy import REGISTRY, Strategy, registered

VARIABLE = "EXPLORER_STRATEGIES"
"""Environment variable with places of strategies, separated by blanks. They are there in every program that knows the
strategies by number: the node, the team runner, missions in virtual time."""

NEEDED = ("number", "name", "title", "allocation")

_FILES: Dict[str, ModuleType] = {}


def is_place_of_strategy(key: str) -> bool:
    return ":" in key


def strategy_at(place: str) -> Type[Strategy]:
    """The class at `module:Class` or `path/file.py:Class`, registered. KeyError with what is wrong there."""
    where, _, name = place.rpartition(":")
    try:
        found = getattr(_module(where), name, None)
    except Exception as error:  # whatever the user's module raises
        raise KeyError(f"strategy {place!r}: {type(error).__name__}: {error}") from error
    if not (isinstance(found, type) and issubclass(found, Strategy)):
        raise KeyError(f"strategy {place!r}: {where} has no class {name} that is a Strategy")
    missing = [attribute for attribute in NEEDED if not hasattr(found, attribute)]
    if missing:
        raise KeyError(f"strategy {place!r}: {name} has no {', '.join(missing)}")
    if REGISTRY.get(found.number) is not found:
        try:
            registered(found)
        except ValueError as error:
            raise KeyError(f"strategy {place!r}: {error}") from error
    return found


def strategies_of_environment() -> None:
    """Registers what the environment variable names. What cannot be used ends the program with one line."""
    for place in os.environ.get(VARIABLE, "").split():
        if not is_place_of_strategy(place):
            raise SystemExit(f"{VARIABLE}: {place!r} is not of the form module:Class or path/file.py:Class")
        try:
            strategy_at(place)
        except KeyError as error:
            raise SystemExit(f"{VARIABLE}: {error.args[0]}") from error


def _module(where: str) -> ModuleType:
    if not where.endswith(".py"):
        return importlib.import_module(where)
    path = os.path.abspath(os.path.expanduser(where))
    if path in _FILES:
        return _FILES[path]
    spec = importlib.util.spec_from_file_location(os.path.splitext(os.path.basename(path))[0], path)
    if spec is None or spec.loader is None:
        raise ImportError(f"{path} cannot be read as a module")
    module = importlib.util.module_from_spec(spec)
    _FILES[path] = sys.modules[f"explorer_strategies_outside.{spec.name}"] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del _FILES[path]
        raise
    return module
