"""The hash of the code that a record names."""

import shutil
import sys
from pathlib import Path
from types import ModuleType

import pytest
from rospkg import ResourceNotFound

from mr_measures.record import versions as module
from mr_measures.record.versions import WORLDS, _modules, code_version, named, versions

OWN_WORLDS = Path(__file__).resolve().parents[3] / "worlds"


@pytest.fixture
def tree(tmp_path, monkeypatch):
    """A made-up source tree in place of this one; what its code is called now."""
    for name in (
        "packages/explorer/src/explorer/a.py", "packages/explorer/src/cpp/a.cpp", "packages/explorer/src/cpp/a.hpp",
        "packages/explorer/msg/Bid.msg", "packages/explorer/CMakeLists.txt", "packages/mr_launch/config/slam.yaml",
    "packages/explorer/nodes/explorer", "packages/mr_launch/launch/robot.launch", "packages/mr_robot/robots/own.yaml",
        "packages/adhoc_communication/include/engine.hpp", "packages/adhoc_communication/engine.cmake",
        "worlds/flat.world", "worlds/flat.png", "worlds/robot.inc",
    ):  # fmt: skip
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("before")
    for package in module.PACKAGES:
        (tmp_path / "packages" / package / "src").mkdir(parents=True, exist_ok=True)
    built = ModuleType("explorer")
    built.__path__ = [str(tmp_path / "devel/explorer")]
    monkeypatch.setattr(module, "folder_of", lambda package: tmp_path / "packages" / package)
    monkeypatch.setitem(sys.modules, "explorer", built)

    def version():
        code_version.cache_clear()
        return code_version((tmp_path / "worlds",))

    yield tmp_path, version
    code_version.cache_clear()


@pytest.mark.parametrize("name", [
    "packages/explorer/src/explorer/a.py", "packages/explorer/src/cpp/a.cpp", "packages/explorer/src/cpp/a.hpp",
    "packages/explorer/msg/Bid.msg", "packages/explorer/CMakeLists.txt", "packages/mr_launch/config/slam.yaml",
    "packages/explorer/nodes/explorer", "packages/mr_launch/launch/robot.launch", "packages/mr_robot/robots/own.yaml",
    "packages/adhoc_communication/include/engine.hpp", "packages/adhoc_communication/engine.cmake",
    "worlds/flat.world", "worlds/flat.png", "worlds/robot.inc",
])  # fmt: skip
def test_sources_parameters_and_worlds_count(tree, name):
    folder, version = tree
    before = version()
    (folder / name).write_text("after")
    assert version() != before


@pytest.mark.parametrize("name", [
    "devel/explorer/_grid.so", "devel/explorer/msg/_Bid.py", "packages/explorer/src/explorer/_grid.so",
    "packages/explorer/src/explorer/__pycache__/a.pyc", "packages/explorer/README.md",
    "packages/explorer/test/test_a.py", "worlds/flat.reference.json",
])  # fmt: skip
def test_build_products_and_what_describes_do_not(tree, name):
    folder, version = tree
    before = version()
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text("built")
    assert version() == before


def test_a_name_that_moves_counts(tree):
    folder, version = tree
    before = version()
    sources = folder / "packages/explorer/src/explorer"
    (sources / "a.py").rename(sources / "b.py")
    assert version() != before


def test_where_there_are_no_sources_compiled_modules_count(tree):
    folder, version = tree
    shutil.rmtree(folder / "packages/explorer/src")
    (folder / "devel/explorer").mkdir(parents=True)
    (folder / "devel/explorer/_grid.so").write_text("before")
    before = version()
    (folder / "devel/explorer/_grid.so").write_text("after")
    assert version() != before


def test_only_what_is_imported_counts(tmp_path):
    relay, source, behind = (tmp_path / name for name in ("relay", "source", "behind"))
    for folder, names in (
        (relay, ("__init__.py", "_fast.so")), (source, ("__init__.py", "a.py", "b.py")), (behind, ("a.py", "_fast.so"))
    ):  # fmt: skip
        folder.mkdir()
        for name in names:
            (folder / name).write_text("")
    package = ModuleType("package")
    package.__path__ = [str(relay), str(source), str(behind)]
    assert _modules(package) == [relay / "_fast.so", source / "a.py", source / "b.py"]


def test_the_worlds_of_this_project_are_among_them():
    assert {"office26x15.world", "office26x15.png", "small8x8.world", "pioneer.inc"} <= named(OWN_WORLDS, WORLDS).keys()


def test_it_is_the_same_again():
    (first, again) = (versions("mr_launch", [OWN_WORLDS])["code"] for _ in range(2))
    code_version.cache_clear()
    assert first == again == versions("mr_experiments", [OWN_WORLDS])["code"] and len(first) == 12


def test_a_package_that_is_not_installed_is_passed_over(tree, monkeypatch):
    folder, version = tree
    before = version()

    def folder_of(package):
        if package == "mr_experiments":
            raise ResourceNotFound(package)
        return folder / "packages" / package

    monkeypatch.setattr(module, "folder_of", folder_of)
    assert version() == before, "its folder here is empty"
