"""The folder of the log files."""

import os

import pytest

from map_merger.ros_logs import LogError, LogFolder


def test_a_folder_that_cannot_be_is_told_before_anything_is_to_be_written(tmp_path):
    """The node started, and told at the first call of ~logOutput, a mission later."""
    (tmp_path / "file").write_text("")
    with pytest.raises(LogError, match=r"^parameter log_path is '\S+/file/logs': .*Not a directory"):
        LogFolder(str(tmp_path / "file/logs"), "robot_0")


def test_so_is_one_that_cannot_be_written_to(tmp_path, monkeypatch):
    LogFolder(str(tmp_path), "robot_0")
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # tests may run as root, who may do all
    with pytest.raises(LogError, match=r"map_merger/robot_0 cannot be written to$"):
        LogFolder(str(tmp_path), "robot_0")
