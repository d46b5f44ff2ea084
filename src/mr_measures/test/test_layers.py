"""The package stands on mr_grid alone: it knows no ROS, no simulator and no host."""

import re
from pathlib import Path

SOURCES = Path(__file__).resolve().parents[2]
BELOW = {"mr_grid", "mr_measures"}
ROS = {"rospy", "nav_msgs", "geometry_msgs"}


def test_it_imports_nothing_of_what_uses_it():
    others = {path.parent.name for path in SOURCES.glob("*/package.xml")} - BELOW | ROS
    for path in (SOURCES / "mr_measures" / "src").rglob("*.py"):
        imported = set(re.findall(r"^\s*(?:from|import) (\w+)", path.read_text(encoding="utf-8"), re.M))
        assert not imported & others, f"{path} imports {imported & others}"
