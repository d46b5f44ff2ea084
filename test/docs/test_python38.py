"""The core packages and what they need keep to Python 3.8, which Ubuntu 20.04 has: syntax, and what is evaluated when a
module is imported."""

import ast
from pathlib import Path

import pytest
from pages import REPOSITORY

CORE = ("adhoc_communication", "map_merger", "explorer", "mr_grid", "mr_plans")
PLACES = ("src", "nodes", "scripts", "examples")
GENERIC = {
    "dict",
    "frozenset",
    "list",
    "set",
    "tuple",
    "type",
    "Callable",
    "Iterator",
    "Iterable",
    "Sequence",
    "Mapping",
}
NEWER = {"removeprefix", "removesuffix", "bit_count", "pairwise", "batched", "is_relative_to"}  # methods and functions
NEWER_ARGUMENTS = {("zip", "strict")}


def is_python(path: Path) -> bool:
    if path.suffix == ".py":
        return True
    return path.suffix == "" and path.is_file() and path.open("rb").readline().startswith(b"#!/usr/bin/env python3")


def files():
    found = [path for package in CORE for place in PLACES for path in (REPOSITORY / "src" / package / place).rglob("*")]
    return sorted(path for path in found if is_python(path))


def faults(text, name="x.py"):
    """What Python 3.8 cannot do, with the line."""
    try:
        tree = ast.parse(text, name, feature_version=(3, 8))
    except SyntaxError as error:
        return [f"line {error.lineno}: {error.msg}"]
    lazy = any(isinstance(node, ast.ImportFrom) and node.module == "__future__" and
               any(alias.name == "annotations" for alias in node.names) for node in tree.body)  # fmt: skip
    abstract = {alias.asname or alias.name for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)
                and node.module == "collections.abc" for alias in node.names}  # fmt: skip
    annotations = set()
    for node in ast.walk(tree):
        for field in ("annotation", "returns"):
            part = getattr(node, field, None)
            if part is not None:
                annotations |= {id(each) for each in ast.walk(part)}
    found = []
    for node in ast.walk(tree):
        if lazy and id(node) in annotations:
            continue
        found += [
            f"line {node.lineno}: {fault}" for fault in [_fault(node, abstract, id(node) in annotations)] if fault
        ]
    return found


def _fault(node, abstract, in_annotation):
    if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name):
        name = node.value.id
        builtin = name in GENERIC and name.islower()
        if builtin or name in abstract:
            return f"{name}[...] needs Python 3.9"
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitOr) and in_annotation:
        return "X | Y as a type needs Python 3.10"
    if isinstance(node, ast.Attribute) and node.attr in NEWER:
        return f"{node.attr} needs a later Python"
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        new = [word.arg for word in node.keywords if (node.func.id, word.arg) in NEWER_ARGUMENTS]
        return f"{node.func.id}({new[0]}=...) needs Python 3.10" if new else ""
    return ""


@pytest.mark.parametrize("package", CORE)
def test_core_packages_keep_to_python_38(package):
    own = [path for path in files() if (REPOSITORY / "src" / package) in path.parents]
    assert own
    found = [f"{path.relative_to(REPOSITORY)}: {fault}" for path in own for fault in faults(path.read_text("utf-8"))]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    "text, part",
    [
        ("match x:\n    case 1: pass", "line 2"),
        ("with (open('a') as a, open('b') as b): pass", "line 1"),
        ("Rows = list[int]", "list[...] needs Python 3.9"),
        ("def f(x: dict[str, int]): pass", "dict[...] needs Python 3.9"),
        ("def f(x: int | None): pass", "X | Y as a type needs Python 3.10"),
        ("from collections.abc import Sequence\nRow = Sequence[int]", "Sequence[...] needs Python 3.9"),
        ("'ab'.removeprefix('a')", "removeprefix needs a later Python"),
        ("zip(a, b, strict=True)", "zip(strict=...) needs Python 3.10"),
    ],
)
def test_what_python_38_cannot_do_is_seen(text, part):
    assert any(part in fault for fault in faults(text))


@pytest.mark.parametrize(
    "text",
    [
        "from __future__ import annotations\ndef f(x: list[int] | None) -> dict[str, int]: pass",
        "from typing import List\nRows = List[int]",
        "if (n := 3): print(f'{n=}')",
        "x = 3 | 4\nrows[3]",
    ],
)
def test_what_it_can_do_is_let_pass(text):
    assert not faults(text)
