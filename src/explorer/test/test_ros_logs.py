"""The log files of the node on disks that take none."""

import builtins
import errno
import os
import pkgutil
from pathlib import Path
from typing import Any

import pytest

import explorer

explorer.__path__ = pkgutil.extend_path(explorer.__path__, "explorer")
pytest.importorskip("rospy", reason="ROS is not here")

from explorer import ros_logs  # noqa: E402
from explorer.errors import ExplorerError  # noqa: E402
from explorer.messages import WriteLog  # noqa: E402


@pytest.mark.parametrize("goes_on", [False, True])
def test_a_folder_that_cannot_be_ends_the_node(tmp_path: Path, goes_on: bool) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ExplorerError, match=r"^parameter ~log_path is '\S+/file/logs': .*Not a directory"):
        ros_logs.LogFolder(str(tmp_path / "file/logs"), "robot_0", goes_on)


def test_so_does_one_that_cannot_be_written_to_any_more(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A node that went on with a former mission told of it only when something was to be written."""
    ros_logs.LogFolder(str(tmp_path), "robot_0", goes_on=False)
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # tests may run as root, who may do all
    with pytest.raises(ExplorerError, match=r"explorer/robot_0 cannot be written to$"):
        ros_logs.LogFolder(str(tmp_path), "robot_0", goes_on=True)


def test_a_full_disk_keeps_no_robot_from_exploring(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It ended the node, each time that it was started again, while the mission of others went on unrecorded."""
    said = []
    monkeypatch.setattr(ros_logs.rospy, "logwarn_throttle", lambda period, text: said.append(text))

    def full(*_: Any) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patch:
        patch.setattr(builtins, "open", full)
        folder = ros_logs.LogFolder(str(tmp_path), "robot_0", goes_on=False)
    reason = "No space left on device; the mission goes on without"
    assert said == [f"explorer: cannot write the log in {tmp_path}/explorer/robot_0: {reason}"]
    folder.write(WriteLog("exploration.log", "complete=1\n", append=False))
    assert (tmp_path / "explorer/robot_0/exploration.log").read_text() == "complete=1\n"
