"""Values know no ROS: only shells import the modules that do."""

import re
from pathlib import Path

SOURCES = Path(__file__).resolve().parents[2]
SHELLS = re.compile(r"((?:ros|tf)_\w+|node|\w+_node)\.py|stageros\.py")
ROS = re.compile(
    r"^\s*(?:from|import) (?:rospy|nav_msgs|geometry_msgs|mr_grid\.ros(?:_\w+)?)\b|from mr_grid import .*\bros\b", re.M
)


def test_only_modules_named_so_know_ros():
    modules = (SOURCES / "mr_grid" / "src" / "mr_grid").glob("*.py")
    knowing = {path.name for path in modules if ROS.search(path.read_text(encoding="utf-8"))}
    assert knowing == {"ros.py", "ros_connections.py", "ros_laser.py", "ros_map_frame.py", "ros_node.py"}


def test_only_shells_import_them():
    users = [
        path
        for path in SOURCES.glob("*/src/*/**/*.py")
        if re.search(r"mr_grid\.ros(?:_\w+)?\b|from mr_grid import .*\bros\b", path.read_text(encoding="utf-8"))
        and path.parts[-2:] != ("mr_grid", "__init__.py")
    ]
    assert [str(path) for path in users if not SHELLS.fullmatch(path.name)] == []


def test_kernels_have_one_pose_and_one_point():
    """SLAM, navigation and the simulator had one each, and wrote out the same algebra."""
    kernels = [path for path in SOURCES.glob("*/src/cpp/**/*") if path.suffix in (".cpp", ".hpp")]
    own = re.compile(r"\b(?:struct|class) (?:Pose|Point|Motion)\b|\bremainder\([^;]*2\.0 \* M_PI")
    assert len(kernels) > 100
    assert [str(path) for path in kernels if own.search(path.read_text(encoding="utf-8"))] == []


def test_this_package_stands_below_all_others():
    names = {path.parent.name for path in SOURCES.glob("*/package.xml")} - {"mr_grid"}
    for path in (SOURCES / "mr_grid" / "src").rglob("*.py"):
        imported = set(re.findall(r"^\s*(?:from|import) (\w+)", path.read_text(encoding="utf-8"), re.M))
        assert not imported & names, f"{path} imports {imported & names}"
