"""The configurations of rviz name topics that there are."""

from pathlib import Path

import pytest
import yaml

from explorer.names import names_for
from explorer.options import load

FILES = sorted((Path(__file__).resolve().parents[1] / "rviz").glob("*.rviz"))
OTHERS = {  # of the nodes of robot.launch and its drivers
    "/map", "/base_scan", "/move_base/plan", "/map_merger/global_map", "/map_merger/markers",
}  # fmt: skip


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_topics_are_published(file):
    published = {
        f"/{name}".replace("/~", "/explorer/") for name in names_for(load({}, host_name="robot_0")).published.values()
    }
    displays = yaml.safe_load(file.read_text(encoding="utf-8"))["Visualization Manager"]["Displays"]
    topics = {display[key] for display in displays for key in ("Topic", "Marker Topic") if key in display}
    assert len(topics) >= 4 and topics <= published | OTHERS


def test_all_topics_of_a_robot_are_renamed_for_one_of_several_under_one_master():
    view = yaml.safe_load((FILES[0].parent / "robot.rviz").read_text(encoding="utf-8"))["Visualization Manager"]
    read = [*view["Displays"], *view["Tools"]]
    topics = {each[key].lstrip("/") for each in read for key in ("Topic", "Marker Topic") if key in each}
    readme = (FILES[0].parents[1] / "README.md").read_text(encoding="utf-8")
    renamed = readme.split("$(for topic in ")[1].split("; do")[0].replace("\\", "").split()
    assert set(renamed) == topics
