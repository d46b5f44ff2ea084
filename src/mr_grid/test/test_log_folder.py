"""The folder of a node's log files: there and writable, or told when the node starts."""

import errno
import os

import pytest

from mr_grid.log_folder import log_folder


def test_it_is_made_below_the_path_and_may_be_there_already(tmp_path):
    for _ in range(2):
        folder = log_folder(str(tmp_path / "logs"), "explorer", "robot_0")
        assert folder == str(tmp_path / "logs/explorer/robot_0") and os.path.isdir(folder)


def test_a_tilde_is_the_home_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    assert log_folder("~/logs", "map_merger", "anna") == str(tmp_path / "logs/map_merger/anna")


def test_without_a_path_there_is_none(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert log_folder("", "explorer", "robot_0") == "" and not list(tmp_path.iterdir())


def test_one_that_cannot_be_made_is_an_error(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="Not a directory"):
        log_folder(str(tmp_path / "file/logs"), "explorer", "robot_0")


def test_so_is_one_that_is_there_and_cannot_be_written_to(tmp_path, monkeypatch):
    log_folder(str(tmp_path), "explorer", "robot_0")
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # tests may run as root, who may do all
    with pytest.raises(OSError, match=r"explorer/robot_0 cannot be written to$"):
        log_folder(str(tmp_path), "explorer", "robot_0")


@pytest.mark.parametrize("reason", [errno.ENOSPC, errno.EDQUOT])
def test_a_full_disk_is_none(reason, tmp_path, monkeypatch):
    """A robot whose disk was full when it began did not explore."""

    def full(path, exist_ok):
        raise OSError(reason, os.strerror(reason), path)

    monkeypatch.setattr(os, "makedirs", full)
    assert log_folder(str(tmp_path), "explorer", "robot_0") == str(tmp_path / "explorer/robot_0")
