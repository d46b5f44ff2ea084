"""`python3 -m explorer`: what it prints, draws and refuses."""

import json
import os
from typing import Any, List

import cv2
import numpy as np
import pytest
from conftest import drawn
from test_scene_file import decisions
from usual_robot import options_with

from explorer import scene_file
from explorer.command_line.arguments import main
from explorer.survey import survey

HALL = [
    "                           ",
    "     .....      #########  ",
    "######...############## #  ",
    "#......................# #.",
    "#.......................#..",
    "#......................# ..",
    "####### ##########.##### ..",
]


@pytest.fixture
def map_yaml(tmp_path: Any) -> str:
    """The hall as map_server writes it: a way out above, a door below, a room without a way."""
    cells = drawn(HALL, scale=8).cells
    pixels = np.select([cells < 0, cells == 0], [205, 254], 0).astype(np.uint8)[::-1]
    cv2.imwrite(str(tmp_path / "hall.pgm"), pixels)
    text = "image: hall.pgm\nresolution: 0.1\norigin: [-1.0, -2.0, 0.0]\n"
    (tmp_path / "hall.yaml").write_text(text + "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n")
    return str(tmp_path / "hall.yaml")


@pytest.fixture
def scene_json(tmp_path: Any) -> str:
    decision = next(made for made in decisions(7) if made.bids and made.choice is not None)
    path = tmp_path / "scene.json"
    path.write_text(scene_file.text_of(decision))
    return str(path)


def run(capsys: Any, *arguments: str) -> str:
    assert main(list(arguments)) == 0
    return str(capsys.readouterr().out)


def test_frontiers_with_place_length_and_reason(capsys: Any, map_yaml: str) -> None:
    found = json.loads(run(capsys, "frontiers", map_yaml, "--json", "--at", "1.0", "-0.5"))
    goals = [frontier for frontier in found["frontiers"] if frontier["reason"] is None]
    assert [frontier["length"] for frontier in goals] == pytest.approx([5.2, 0.6])
    assert goals[0]["place"] == pytest.approx([4.95, 2.75]) and goals[1]["place"] == pytest.approx([4.95, -1.15])
    others = [frontier for frontier in found["frontiers"] if frontier["reason"] is not None]
    assert {other["reason"] for other in others} == {"no place to look from"}
    assert [other["place"][0] > 18.0 for other in others] == [True, True]
    clusters = {cluster["number"]: cluster for cluster in found["clusters"]}
    assert all(clusters[frontier["clusters"][0]]["goals"] > 0 for frontier in goals)
    closed = clusters[others[1]["clusters"][0]]
    assert closed["goals"] == 0 and closed["way"] is None and clusters[goals[0]["clusters"][0]]["way"] > 2.0
    table = run(capsys, "frontiers", map_yaml)
    assert "no goal: no place to look from" in table and "unknown [m^2]" in table


def test_short_frontiers_are_noise_by_the_length_given(capsys: Any, map_yaml: str) -> None:
    def noise(length: str) -> List[dict]:
        found = json.loads(run(capsys, "frontiers", map_yaml, "--json", "--shortest", length))
        return [f for f in found["frontiers"] if f["reason"] == f"noise: shorter than {length} m"]

    assert noise("0") == []
    assert noise("50") and all(frontier["length"] < 50.0 for frontier in noise("50"))
    assert all(frontier["clusters"] == [] for frontier in noise("50"))


def test_lengths_of_a_survey_are_those_of_its_cells() -> None:
    seen = survey(drawn(HALL, scale=8), options_with())
    for stretch in seen.stretches:
        assert stretch.length == pytest.approx(0.1 * len(stretch.cells))
        assert min(np.hypot(*(stretch.cells - stretch.place).T)) < 1e-9


def test_decide_tells_choice_costs_and_whether_it_is_as_recorded(capsys: Any, scene_json: str) -> None:
    decision = scene_file.read(scene_json)
    found = json.loads(run(capsys, "decide", scene_json, "--json"))
    assert found["choice"] == decision.choice and found["as_recorded"] is True and found["unit"] == "cluster"
    rows = {row["number"]: row for row in found["clusters"]}
    assert set(rows) == {cluster.number for cluster in decision.scene.clusters}
    assert {n: row["bids"]["robot_1"] for n, row in rows.items() if row["bids"]} == decision.bids["robot_1"]
    table = run(capsys, "decide", scene_json)
    assert f"strategy coordinated: cluster {decision.choice}, as recorded" in table and "robot_1" in table


@pytest.mark.parametrize("strategy, name, unit", [("3", "nearest", "frontier"), ("auction", "auction", "cluster")])
def test_decide_by_another_strategy(capsys: Any, scene_json: str, strategy: str, name: str, unit: str) -> None:
    found = json.loads(run(capsys, "decide", scene_json, "--strategy", strategy, "--json"))
    assert (found["strategy"], found["unit"], found["as_recorded"]) == (name, unit, None)
    assert found["choice"] is not None


@pytest.mark.parametrize("command", ["frontiers", "decide"])
def test_pictures_show_more_than_one_colour(
    capsys: Any, tmp_path: Any, map_yaml: str, scene_json: str, command: str
) -> None:
    pytest.importorskip("matplotlib")
    picture = str(tmp_path / "out.png")
    run(capsys, command, map_yaml if command == "frontiers" else scene_json, "--plot", picture)
    pixels = cv2.imread(picture).reshape(-1, 3).astype(int)
    assert np.count_nonzero(np.ptp(pixels, axis=1) > 60) > 50


@pytest.mark.parametrize(
    "arguments, problem",
    [
        (["frontiers", "none.yaml"], "none.yaml: No such file"),
        (["frontiers", "MAP", "--at", "500", "0"], "no robot of radius 0.25 m can be at"),
        (["frontiers", "MAP", "--plot", "NOWHERE/out.png"], "out.png"),
        (["decide", "none.json"], "none.json: No such file"),
        (["decide", "MAP"], "hall.yaml: not JSON"),
        (["decide", "SCENE", "--strategy", "best"], "strategy 'best' is unknown; there are 0 nearest_path"),
        (["decide", "SCENE", "--strategy", "99"], "strategy 99 is unknown"),
    ],
)
def test_one_line_and_exit_code_2(
    capsys: Any, tmp_path: Any, map_yaml: str, scene_json: str, arguments: List[str], problem: str
) -> None:
    places = {"MAP": map_yaml, "SCENE": scene_json, "NOWHERE": os.path.join(str(tmp_path), "nowhere")}
    arguments = [places.get(each, each.replace("NOWHERE", places["NOWHERE"])) for each in arguments]
    assert main(arguments) == 2
    error = capsys.readouterr().err
    assert problem in error and error.count("\n") == 1 and error.startswith("explorer: ")


@pytest.mark.parametrize(
    "arguments", [[], ["frontiers"], ["frontiers", "a", "--at", "1", "x"], ["decide", "a", "--plot", "b"]]
)
def test_arguments_that_cannot_be_used(capsys: Any, arguments: List[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(arguments)
    assert ended.value.code == 2
    assert "usage: python3 -m explorer" in capsys.readouterr().err
