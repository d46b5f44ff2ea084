"""What the nodes of a robot load when they start: a robot's computer is small, and each has its own copy of it."""

import subprocess
import sys
from pathlib import Path

import pytest

PACKAGES = Path(__file__).parents[2]
OF_FILE = "import runpy; runpy.run_path({!r}, run_name='read')"
NODES = {
    "explorer": OF_FILE.format(str(PACKAGES / "explorer/nodes/explorer")),
    "map_merger": OF_FILE.format(str(PACKAGES / "map_merger/nodes/map_merger")),
    "move_base": "import mr_robot.navigation.node",
    "slam": "import mr_robot.slam.node",
}
FOREIGN = {"cv2", "matplotlib", "mr_measures", "mr_plans"}


@pytest.mark.parametrize("node", NODES)
def test_node_loads_only_what_it_needs(node):
    foreign = FOREIGN | ({"mr_robot._slam"} if node != "slam" else set())
    script = f"{NODES[node]}\nimport sys; print(sorted({foreign!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout.splitlines()[-1] == "[]"
