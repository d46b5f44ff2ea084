"""The core packages and what they need keep to what Ubuntu 20.04 has: Python 3.8 (syntax, and what is evaluated when a
module is imported), NumPy 1.17 and SciPy 1.3 (modules and functions), pybind11 2.4."""

import ast
import re
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
NEWER_MODULES = {
    "scipy.fft": "SciPy 1.4",
    "numpy.typing": "NumPy 1.20",
    "tomllib": "Python 3.11",
    "zoneinfo": "Python 3.9",
}
NEWER_NUMPY = {"broadcast_shapes", "sliding_window_view", "permuted", "trapezoid", "concat"}
NEWER_PYBIND11 = {
    r"py::module_\b": "module_",
    r"py::(kw_only|pos_only|type|prepend|raise_from|const_name|set_error|native_enum)\b": "a later pybind11",
    r"std::string_view\s+\w+\s*(=|\{)": "a string_view of bytes",
}


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
    guarded = {id(part) for node in ast.walk(tree) if isinstance(node, ast.Try) for part in node.body}
    imports = [node for node in ast.walk(tree) if id(node) not in guarded]
    found = [f"line {node.lineno}: {name} needs {NEWER_MODULES[name]}" for node in imports for name in _imported(node)]
    for node in ast.walk(tree):
        if lazy and id(node) in annotations:
            continue
        found += [
            f"line {node.lineno}: {fault}" for fault in [_fault(node, abstract, id(node) in annotations)] if fault
        ]
    return found


def _imported(node):
    """Those modules of an import that are too new."""
    names = []
    if isinstance(node, ast.Import):
        names = [alias.name for alias in node.names]
    elif isinstance(node, ast.ImportFrom) and node.module:
        names = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
    return [name for name in names if name in NEWER_MODULES]


def _fault(node, abstract, in_annotation):
    if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Name):
        name = node.value.id
        builtin = name in GENERIC and name.islower()
        if builtin or name in abstract:
            return f"{name}[...] needs Python 3.9"
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitOr) and in_annotation:
        return "X | Y as a type needs Python 3.10"
    if isinstance(node, ast.Attribute) and node.attr in NEWER | NEWER_NUMPY:
        return f"{node.attr} needs a later Python or NumPy"
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
        ("'ab'.removeprefix('a')", "removeprefix needs a later Python or NumPy"),
        ("zip(a, b, strict=True)", "zip(strict=...) needs Python 3.10"),
        ("from scipy import fft", "scipy.fft needs SciPy 1.4"),
        ("from scipy.fft import rfft2", "scipy.fft needs SciPy 1.4"),
        ("import numpy.typing", "numpy.typing needs NumPy 1.20"),
        ("np.broadcast_shapes((3,), (1,))", "broadcast_shapes needs a later Python or NumPy"),
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
        "try:\n    from scipy.fft import rfft2\nexcept ImportError:\n    from numpy.fft import rfft2",
    ],
)
def test_what_it_can_do_is_let_pass(text):
    assert not faults(text)


def bindings():
    found = [path for package in CORE for path in (REPOSITORY / "src" / package).rglob("*.?pp")]
    return [path for path in found if "<pybind11/" in path.read_text(encoding="utf-8")]


def faults_of_bindings(text):
    """What pybind11 2.4.3 cannot do, with the line."""
    return [
        f"line {number}: {what}"
        for number, line in enumerate(text.splitlines(), 1)
        for pattern, what in NEWER_PYBIND11.items()
        if re.search(pattern, line)
    ]


def test_bindings_keep_to_pybind11_of_ubuntu_2004():
    assert bindings()
    found = [
        f"{path.relative_to(REPOSITORY)}: {fault}"
        for path in bindings()
        for fault in faults_of_bindings(path.read_text(encoding="utf-8"))
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    "text", ["void bind(py::module_& m) {", "const std::string_view view = octets;", "py::kw_only()"]
)
def test_what_pybind11_of_ubuntu_2004_cannot_do_is_seen(text):
    assert faults_of_bindings(text)
    assert not faults_of_bindings("void bind(py::module& m) { const std::string text = octets; }")
