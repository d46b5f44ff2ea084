"""The tool team_key: what it writes, and what it refuses."""

import re
import stat
import subprocess
from pathlib import Path

import pytest

TOOL = Path(__file__).parents[1] / "scripts" / "team_key"
KEY = re.compile(r"^[0-9a-f]{64}$", re.MULTILINE)


def run(*words):
    return subprocess.run([str(TOOL), *map(str, words)], capture_output=True, text=True, check=False)


def keys(path):
    return KEY.findall(path.read_text())


@pytest.fixture
def key_file(tmp_path):
    path = tmp_path / "team.key"
    assert run("create", path).returncode == 0
    return path


def test_a_new_file_holds_one_random_key_for_its_owner_only(key_file, tmp_path):
    assert len(keys(key_file)) == 1
    assert stat.S_IMODE(key_file.stat().st_mode) == 0o600
    other = tmp_path / "other.key"
    run("create", other)
    assert keys(other) != keys(key_file)


def test_an_existing_file_is_not_overwritten(key_file):
    before = key_file.read_text()
    result = run("create", key_file)
    assert result.returncode == 1
    assert "exists already" in result.stderr
    assert key_file.read_text() == before


def test_roll_over(key_file, tmp_path):
    new = tmp_path / "new.key"
    run("create", new)
    (old_key,), (new_key,) = keys(key_file), keys(new)
    assert run("add", key_file, new).returncode == 0
    assert keys(key_file) == [old_key, new_key]
    assert run("promote", key_file).returncode == 0
    assert keys(key_file) == [new_key, old_key]
    shown = run("show", key_file).stdout.splitlines()
    assert [line.split(maxsplit=1)[1] for line in shown] == ["seals and opens", "opens"]
    assert new_key not in run("show", key_file).stdout
    assert run("drop", key_file).returncode == 0
    assert keys(key_file) == [new_key]
    assert stat.S_IMODE(key_file.stat().st_mode) == 0o600


@pytest.mark.parametrize("text, complaint", [("", "holds no key"), ("abc\n", "line 1"), ("zz" * 32, "line 1")])
def test_damaged_files_are_named(tmp_path, text, complaint):
    path = tmp_path / "bad.key"
    path.write_text(text)
    result = run("promote", path)
    assert result.returncode == 1
    assert str(path) in result.stderr and complaint in result.stderr
    assert "Traceback" not in result.stderr


def test_a_missing_file_is_named(tmp_path):
    result = run("show", tmp_path / "none.key")
    assert result.returncode == 1
    assert "none.key" in result.stderr and "Traceback" not in result.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["show", "{folder}/none"], "{folder}/none is not there; 'team_key create {folder}/none' makes a new one"),
        (["add", "{key}", "{folder}/none"], "{folder}/none is not there"),
        (["show", "{folder}"], "{folder} cannot be read: Is a directory; give a file of team_key"),
        (["show", "{folder}/binary"], "{folder}/binary is no text; give a file of team_key"),
        (
            ["create", "{folder}/none/key"],
            "{folder}/none/key cannot be written: No such file or directory; give a file",
        ),
    ],
)
def test_a_file_that_cannot_be_used_is_named_with_the_remedy(words, said, key_file, tmp_path):
    (tmp_path / "binary").write_bytes(b"\xff\xfe")
    names = {"folder": tmp_path, "key": key_file}
    result = run(*(word.format(**names) for word in words))
    assert result.returncode == 1 and result.stderr.startswith(f"team_key: {said.format(**names)}")
    assert result.stderr.count("\n") == 1
