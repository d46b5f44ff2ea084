"""The playback tests see what they are there for: with one transform reversed or one bid dropped they fail.

Each mutation replaces one line in a copy of the package, which comes first on PYTHONPATH while the same rostest runs.
adhoc_communication is compiled: there the bid is dropped on its way to the radio, in a copy of the bag.
"""

import importlib
import os
import shutil
import subprocess
from pathlib import Path
from typing import NamedTuple

import pytest
import rosbag

FOLDER = Path(__file__).resolve().parent
LIMIT_S = 180
DIFFERS = "differs from the stored expectation"


class Mutation(NamedTuple):
    """`before` becomes `after` in a module; then the test of the package has to fail with `complaint`."""

    package: str
    module: str
    before: str
    after: str
    complaint: str


MUTATIONS = {
    "transform broadcast reversed": Mutation(
        "map_merger",
        "ros_io.py",
        "    for child, transform in transforms:\n",
        "    for child, transform in [(child, transform.inverse()) for child, transform in transforms]:\n",
        "turn of map -> robot_1/map: expected",
    ),
    "transform of the drawn map reversed": Mutation(
        "map_merger",
        "merged_map.py",
        "self._map.set_layer(name, grid, version, transform)",
        "self._map.set_layer(name, grid, version, transform.inverse())",
        "global_map",
    ),
    "transform of points reversed": Mutation(
        "map_merger",
        "view.py",
        "return placement.transform.apply_point(x, y)",
        "return placement.transform.inverse().apply_point(x, y)",
        "point (3.0, -1.0) of robot_1[0]: expected",
    ),
    "transform of frontiers reversed": Mutation(
        "explorer",
        "ros_io.py",
        "rigid_transform(np.array(PROBES), np.array(images, dtype=float))",
        "rigid_transform(np.array(images, dtype=float), np.array(PROBES))",
        ".bid: expected",
    ),
    "bid dropped from an answer": Mutation(
        "explorer",
        "auctions.py",
        "            available.append(Bid(bid.elements, -1.0 if cluster is None else bid_for(cluster)))\n",
        "            available.append(Bid(bid.elements, -1.0 if cluster is None else bid_for(cluster)))\n"
        "        available = available[1:]\n",
        "available_clusters: expected a list of",
    ),
    "bid dropped from a start": Mutation(
        "explorer",
        "bidding.py",
        "bids = {cluster.number: self._strategy.bid(scene, cluster) for cluster in scene.open}",
        "bids = {cluster.number: self._strategy.bid(scene, cluster) for cluster in scene.open[1:]}",
        "requested_clusters[0].bid: expected",
    ),
}


def run(test: str, folder: Path, *arguments: str, path: str = "") -> "subprocess.CompletedProcess[str]":
    """The rostest with its results in `folder`, so that they do not count as results of this build."""
    environment = dict(os.environ, ROS_HOME=str(folder), ROS_TEST_RESULTS_DIR=str(folder / "results"))
    environment["PYTHONPATH"] = os.pathsep.join(filter(None, [path, os.environ.get("PYTHONPATH", "")]))
    command = ["rostest", str(FOLDER / test), *arguments]
    return subprocess.run(
        command,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=LIMIT_S,
    )


def copy_of(package: str, module: str, folder: Path) -> Path:
    """A copy of a package, its generated messages included; returns the path of the module in it."""
    paths = importlib.import_module(package).__path__
    # In a development space the generated part is a folder of its own, which ends at a file that looks for the other.
    for path in sorted(paths, key=lambda path: Path(path, module).exists()):
        shutil.copytree(path, folder / package, dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__"))
    return folder / package / module


@pytest.mark.parametrize("package, module", [("map_merger", "agent.py"), ("explorer", "agent.py")])
def test_an_unchanged_copy_passes(package: str, module: str, tmp_path: Path) -> None:
    copy_of(package, module, tmp_path / "copy")
    result = run(f"{package}.test", tmp_path, path=str(tmp_path / "copy"))
    assert result.returncode == 0, result.stdout


@pytest.mark.parametrize("name", MUTATIONS)
def test_a_mutation_fails(name: str, tmp_path: Path) -> None:
    mutation = MUTATIONS[name]
    module = copy_of(mutation.package, mutation.module, tmp_path / "copy")
    text = module.read_text()
    assert text.count(mutation.before) == 1, f"{mutation.before!r} is not once in {mutation.module}"
    module.write_text(text.replace(mutation.before, mutation.after))
    assert_fails(run(f"{mutation.package}.test", tmp_path, path=str(tmp_path / "copy")), mutation.complaint)


def test_a_bid_that_is_not_sent_fails(tmp_path: Path) -> None:
    dropped = False
    with rosbag.Bag(str(FOLDER / "adhoc_communication.bag")) as before, rosbag.Bag(str(tmp_path / "bag"), "w") as after:
        for topic, message, stamp in before.read_messages():
            if topic == "auction" and message.available_clusters and not dropped:
                message.available_clusters.pop()
                dropped = True
            after.write(topic, message, stamp)
    assert dropped, "there is no bid in the bag"
    assert_fails(
        run("adhoc_communication.test", tmp_path, f"bag:={tmp_path}/bag"), "available_clusters: expected a list of"
    )


def assert_fails(result: "subprocess.CompletedProcess[str]", complaint: str) -> None:
    """The comparison has failed, and nothing else."""
    assert result.returncode != 0, result.stdout
    comparison = result.stdout.partition(DIFFERS)[2]
    assert complaint in comparison, result.stdout
