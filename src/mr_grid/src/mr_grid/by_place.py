"""Classes and functions of the user's own, named by their place: `module:name` or `path/file.py:name`."""

import importlib
import importlib.util
import os
import sys
from types import ModuleType
from typing import Any, Dict

_FILES: Dict[str, ModuleType] = {}


class PlaceError(ValueError):
    """Nothing that can be used is there; the text says why."""


def names_a_place(text: str) -> bool:
    return ":" in text


def object_at(place: str) -> Any:
    """What stands there; the same object each time. Raises PlaceError."""
    where, _, name = place.rpartition(":")
    if not where:
        raise PlaceError(f"{place!r} is no place: module:NAME or FILE.py:NAME")
    try:
        return getattr(_module(where), name)
    except AttributeError:
        raise PlaceError(f"{place!r}: {where} has no {name}") from None
    except Exception as error:  # whatever the user's module raises
        raise PlaceError(f"{place!r}: {type(error).__name__}: {error}") from error


def _module(where: str) -> ModuleType:
    if not where.endswith(".py"):
        return importlib.import_module(where)
    path = os.path.abspath(os.path.expanduser(where))
    if path not in _FILES:
        _FILES[path] = _read(path)
    return _FILES[path]


def _read(path: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"by_place_{os.path.splitext(os.path.basename(path))[0]}", path)
    if spec is None or spec.loader is None:
        raise ImportError(f"{path} cannot be read as a module")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[spec.name]
        raise
    return module
