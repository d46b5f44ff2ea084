"""The hash of the code that a record names."""

from types import ModuleType

from mr_experiments.code_version import _modules, code_version


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


def test_it_is_the_same_again():
    assert code_version() == code_version() and len(code_version()) == 12
