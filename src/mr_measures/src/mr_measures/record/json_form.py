"""Frozen dataclasses as JSON documents and back: checked, with the place of a fault in its text.

A field's key is its name unless its type is annotated with a `Key`. A key that is absent or null reads as the field's
default; without a default it must be there. Keys that are not known are passed over. Numbers are finite.
"""

from __future__ import annotations

import dataclasses
import math
import types
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Any, TypeVar

from mr_grid import Pose

_Value = TypeVar("_Value")


@dataclass(frozen=True)
class Key:
    """In the annotation of a field: it has this key."""

    name: str


class Written(Enum):
    """In the annotation of a field: how it is written."""

    UNLESS_DEFAULT = 1  # only when it has another value than its default
    AS_WHOLE = 2  # the only field of its class: its value is the document


class FormError(ValueError):
    """A document that does not say what it should; the text begins with the place of the fault."""


_NOTHING = object()


@dataclass(frozen=True)
class _Field:
    """`default`: _NOTHING without one."""

    name: str
    key: str
    type: Any
    default: Any
    written: Written | None


_KNOWN: dict[type, tuple[_Field, ...]] = {}


def _fields_of(kind: type) -> tuple[_Field, ...]:
    if kind not in _KNOWN:
        hints = typing.get_type_hints(kind, include_extras=True)
        fields = dataclasses.fields(kind)  # type: ignore[arg-type]
        _KNOWN[kind] = tuple(_field_of(field, hints[field.name]) for field in fields)
    return _KNOWN[kind]


def _field_of(field: dataclasses.Field, hint: Any) -> _Field:
    notes: tuple[Any, ...] = getattr(hint, "__metadata__", ())
    key = next((note.name for note in notes if isinstance(note, Key)), field.name)
    written = next((note for note in notes if isinstance(note, Written)), None)
    default = _NOTHING if field.default is dataclasses.MISSING else field.default
    if field.default_factory is not dataclasses.MISSING:
        default = field.default_factory()
    return _Field(field.name, key, hint.__origin__ if notes else hint, default, written)


def _is_whole(kind: type) -> bool:
    return _fields_of(kind)[0].written is Written.AS_WHOLE


# --- to JSON ----------------------------------------------------------------------------------------------------------


def to_json(value: Any) -> Any:
    """Plain values: objects, lists, numbers, texts."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return _object(value)
    if isinstance(value, Mapping):
        return {str(key): to_json(entry) for key, entry in value.items()}
    if isinstance(value, (tuple, list)):
        return [entry if isinstance(entry, (int, float, str)) else to_json(entry) for entry in value]
    return value


def _object(value: Any) -> Any:
    if _is_whole(type(value)):
        return to_json(getattr(value, _fields_of(type(value))[0].name))
    return {
        field.key: to_json(getattr(value, field.name))
        for field in _fields_of(type(value))
        if field.written is not Written.UNLESS_DEFAULT or getattr(value, field.name) != field.default
    }


# --- from JSON --------------------------------------------------------------------------------------------------------


def from_json(kind: type[_Value], document: Any, place: str = "") -> _Value:
    """The dataclass `kind` from its document. Raises FormError; `place`: of the document in a larger one."""
    if not isinstance(document, Mapping):
        raise FormError(f"{place or 'the document'} must be an object, not {_shown(document)}")
    values = {_fields_of(kind)[0].name: document} if _is_whole(kind) else _values_of(kind, document, place)
    try:
        return kind(**values)
    except ValueError as error:
        raise FormError(f"{place}.{error}" if place else str(error)) from None


def _values_of(kind: type, document: Mapping[str, Any], place: str) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for field in _fields_of(kind):
        entry, where = document.get(field.key), f"{place}.{field.key}" if place else field.key
        if entry is not None:
            values[field.name] = _read(field.type, entry, where)
        elif field.default is _NOTHING:
            if field.key not in document or type(None) not in typing.get_args(field.type):
                raise FormError(f"{where} is missing")
            values[field.name] = None
    return values


def _read(form: Any, value: Any, where: str) -> Any:
    if form is Any:
        return value
    arguments = typing.get_args(form)
    if isinstance(form, types.UnionType) or typing.get_origin(form) is typing.Union:
        (inner,) = (each for each in arguments if each is not type(None))
        return _read(inner, value, where)
    if form is Pose:
        return _pose(value, where)
    if dataclasses.is_dataclass(form):
        return from_json(typing.cast(type, form), value, where)
    if typing.get_origin(form) is tuple:
        return _tuple(arguments, value, where)
    if arguments:
        return _mapping(arguments[1], value, where)
    return _scalar(form, value, where)


def _scalar(form: Any, value: Any, where: str) -> Any:
    if form is float and _is_number(value):
        return float(value)
    if form in (bool, int, str) and type(value) is form:
        return value
    what = {float: "a finite number", int: "a whole number", bool: "true or false", str: "a text"}[form]
    raise FormError(f"{where} must be {what}, not {_shown(value)}")


def _tuple(forms: tuple[Any, ...], value: Any, where: str) -> tuple[Any, ...]:
    if not isinstance(value, list):
        raise FormError(f"{where} must be a list, not {_shown(value)}")
    if forms[-1] is not Ellipsis:
        if len(value) != len(forms):
            raise FormError(f"{where} must have {len(forms)} entries, not {len(value)}")
        return tuple(_read(form, entry, f"{where}[{index}]") for index, (form, entry) in enumerate(zip(forms, value)))
    if forms[0] is float and all(map(_is_number, value)):
        return tuple(map(float, value))
    return tuple(_read(forms[0], entry, f"{where}[{index}]") for index, entry in enumerate(value))


def _mapping(form: Any, value: Any, where: str) -> dict[str, Any]:
    if not isinstance(value, Mapping):
        raise FormError(f"{where} must be an object, not {_shown(value)}")
    return {str(key): _read(form, entry, f"{where}.{key}") for key, entry in value.items()}


def _pose(value: Any, where: str) -> Pose:
    if not (isinstance(value, list) and len(value) == 3 and all(map(_is_number, value))):
        raise FormError(f"{where} must be x, y, yaw")
    return Pose(*map(float, value))


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and math.isfinite(value)


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
