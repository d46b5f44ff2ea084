"""The replay: what the page holds, where things lie, and what happens with records that lack something."""

import asyncio
import base64
import copy
import html.parser
import json
import math
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
from made_missions import made_mission, made_robot
from replay_sample import add_snapshots, map_around, sample_record, world_walls

from mr_experiments.replay import replay_data
from mr_experiments.replay.replay import load_record, make_page, page_data, thinned
from mr_experiments.replay.replay_data import ReplayError
from mr_experiments.replay.replay_maps import (
    FREE,
    OCCUPIED,
    UNKNOWN,
    Eye,
    Lookout,
    Picture,
    coarser,
    cropped,
    decode_map,
    known_since,
    load_surroundings,
    paced,
    picture_to_world,
    timed_uri,
    viewpoints,
    wall_picture,
)
from mr_experiments.replay.show_command import main
from mr_grid import Pose
from mr_measures import map_picture
from mr_measures.record.files import document_of, record_of_document
from mr_measures.record.robot_record import Goal, Merge
from mr_measures.record.series import RobotSeries
from mr_page.browser import browser, program
from mr_sim.raster import Grid


@pytest.fixture(scope="module")
def record():
    return sample_record()


@pytest.fixture(scope="module")
def page(record):
    return page_of(record)


def page_of(record):
    """Of the document of a record."""
    return make_page(record_of_document(record))


def data_of(record):
    return page_data(record_of_document(record))


def stored(entry):
    """A map of the document of a record."""
    return map_picture.Picture(entry["png"], entry["resolution"], tuple(entry["origin"]))


def embedded(page: str) -> dict:
    """The data in a page, read as a browser does."""
    match = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert match
    return json.loads(match.group(1))


class Tags(html.parser.HTMLParser):
    """All start tags of a page with their attributes."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict]] = []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))


# The page


def test_page_is_self_contained(page):
    for tag, attributes in Tags(page).tags:
        for name in ("src", "href", "srcset", "data", "action"):
            assert attributes.get(name, "data:").startswith("data:"), (tag, attributes)
    assert not re.search(r"https?:|//[a-z]+\.|@import|url\(|\bimport\b|\bfetch\(|XMLHttpRequest", page)
    assert "default-src 'none'" in page


def test_page_has_no_unfilled_place(page):
    assert "@@" not in page


def test_page_holds_every_robot(record, page):
    data = embedded(page)
    assert [robot["name"] for robot in data["robots"]] == list(record["robots"])
    for robot in data["robots"]:
        series = record["robots"][robot["name"]]["series"]
        for name in ("x", "y", "yaw", "explored", "own", "distance", "bytes", "state"):
            assert robot["series"][name] == pytest.approx(series[name], abs=0.06), name


def test_texts_of_the_record_cannot_leave_their_place(record):
    record = copy.deepcopy(record)
    record["trial"]["scenario"] = "</title><script>alert(1)</script>"
    page = page_of(record)
    assert sum(tag == "script" for tag, _ in Tags(page).tags) == 2
    assert embedded(page)["robots"][0]["goals"][1]["text"] == "no path </script>"


def test_same_record_gives_same_page(record, page):
    assert page_of(copy.deepcopy(record)) == page


def test_page_names_world_scenario_and_outcome(page):
    data = embedded(page)
    assert data["title"] == "small8x8, 2 robots, paper, seed 17"
    assert data["outcome"]["status"] == "finished"


@pytest.mark.parametrize("robots", [1, 16])
def test_any_size_of_team(robots):
    data = embedded(page_of(sample_record(robots, end=20)))
    assert len(data["robots"]) == len(data["views"]) == robots
    assert all(view["team"] is not None and view["alone"] is not None for view in data["views"])


def test_script_is_valid(tmp_path, page):
    if shutil.which("node") is None:
        pytest.skip("node is not installed: run tools/install_dependencies browser")
    script = tmp_path / "page.js"
    script.write_text(re.findall(r"<script>(.*?)</script>", page, re.DOTALL)[0])
    subprocess.run(["node", "--check", str(script)], check=True)


def test_page_plays_in_a_browser(tmp_path, page):
    if program() is None and not os.environ.get("REQUIRE_BROWSER"):
        pytest.skip("no headless Chromium: run tools/install_dependencies browser")
    path = tmp_path / "page.html"
    path.write_text(page, encoding="utf-8")

    async def run():
        async with browser() as one:
            tab = await one.open(f"{path.as_uri()}#t=15")
            await tab.wait_for("document.getElementById('clock').textContent === '0:15 / 1:00'")
            assert await tab.run("document.querySelectorAll('#robots tr').length") == 2
            await tab.click("#robots tr:nth-child(2)")
            assert await tab.run("document.getElementById('view').value") == "1"
            await tab.click("#play")
            await tab.wait_for("document.getElementById('clock').textContent === '1:00 / 1:00'")
            await tab.click("#events li:nth-child(3)")
            await tab.wait_for("document.getElementById('clock').textContent === '0:25 / 1:00'")
            assert tab.errors == []

    asyncio.run(run())


AUCTIONS = "[...document.querySelectorAll('#auctions summary')].map((one) => one.textContent)"
ROWS = "[...document.querySelectorAll('#auctions details[open] tbody tr')]"
BIDS = f"{ROWS}.map((row) => [...row.cells].map((cell) => cell.textContent))"
NO_BID = "\N{EN DASH}"


async def seek(tab, time):
    slider = "const s = document.getElementById('slider');"
    await tab.run(f"(() => {{ {slider} s.value = {time}; s.dispatchEvent(new Event('input')); }})()")
    await tab.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


async def replayed(tmp_path, record, look):
    """`look(tab)` at the replay of a record, from second 20 on."""
    path = tmp_path / "page.html"
    path.write_text(page_of(record), encoding="utf-8")
    async with browser() as one:
        tab = await one.open(f"{path.as_uri()}#t=20")
        await tab.wait_for("document.getElementById('clock').textContent === '0:20 / 1:00'")
        await look(tab)
        assert tab.errors == []


needs_browser = pytest.mark.skipif(
    program() is None and not os.environ.get("REQUIRE_BROWSER"),
    reason="no headless Chromium: run tools/install_dependencies browser",
)


@needs_browser
def test_a_replay_shows_auctions_as_they_stood(tmp_path):
    """An auction stood with its result, and with all bids, from its opening on."""
    zero = "0:05robot_0: robot_0 (1.0, 3.0) at 3.0 · 1 of 2 to nobody yet"
    nobody = ["(1.0, 4.0)", NO_BID, "8.0"]

    async def look(tab):
        await seek(tab, 4.9)
        assert await tab.run(AUCTIONS) == []
        await seek(tab, 5.2)
        assert await tab.run(AUCTIONS) == ["0:05robot_0: open: 2 clusters, 0 others have answered"]
        await tab.click("#auctions summary")
        await tab.wait_for(f"{ROWS}.length")  # browsers tell a page of an unfolded element a moment later
        assert await tab.run(BIDS) == [["(1.0, 3.0)", "3.0"], ["(1.0, 4.0)", NO_BID]]
        await seek(tab, 5.6)
        assert await tab.run(AUCTIONS) == ["0:05robot_0: open: 2 clusters, 1 other has answered"]
        assert await tab.run(BIDS) == [["(1.0, 3.0)", "3.0", "3.0"], nobody]
        assert await tab.run("document.querySelectorAll('#auctions b').length") == 1, "the auctioneer, no winner"
        await seek(tab, 6.2)
        assert await tab.run(AUCTIONS) == ["0:06robot_1: open: 2 clusters, 0 others have answered", zero]
        assert await tab.run(BIDS) == [["(1.0, 3.0)", "3.0", "3.0"], nobody], "it stays unfolded"
        await seek(tab, 60.0)
        lost = "1 cluster, no result is recorded"
        assert (await tab.run(AUCTIONS))[:2] == [f"0:31robot_1: {lost}", f"0:30robot_0: {lost}"]
        await tab.click("#robots tr:nth-child(1)")
        await tab.wait_for(f"{AUCTIONS}.length === 2")
        assert await tab.run(AUCTIONS) == [f"0:30robot_0: {lost}", zero]
        await seek(tab, 5.2)
        assert await tab.run(AUCTIONS) == ["0:05robot_0: open: 2 clusters, 0 others have answered"]

    asyncio.run(replayed(tmp_path, sample_record(), look))


@needs_browser
def test_the_auctions_of_a_replay_are_the_newest_up_to_its_time(tmp_path):
    """Nor is the list longer where robots held many."""
    record = sample_record()
    offer = {"x": 1.0, "y": 0.5, "bids": {"robot_0": 3.0}, "explored_by": "robot_0"}
    many = [{"at": 0.5 * n, "id": n, "clusters": 1, "offers": [offer], "decided": 0.5 * n} for n in range(110)]
    record["robots"]["robot_0"]["auctions"] = many
    times = f"{AUCTIONS}.map((line) => line.slice(0, 4))"

    async def look(tab):
        for now, newest, count in ((10.0, 10.0, 22), (30.4, 30.0, 50), (50.0, 50.0, 50)):
            await seek(tab, now)
            found = await tab.run(times)
            assert len(found) == count and found == sorted(found, reverse=True)
            assert found[0] == f"0:{newest:02.0f}"

    asyncio.run(replayed(tmp_path, record, look))


@needs_browser
def test_a_record_without_the_times_of_decisions_says_so(tmp_path):
    """As those of before: the results stand from the opening on."""
    record = sample_record()
    for robot in record["robots"].values():
        for auction in robot["auctions"]:
            auction.pop("decided", None)
            auction.pop("answered", None)
    said = "!document.getElementById('undated').hidden"

    async def look(tab):
        await seek(tab, 5.2)
        assert await tab.run(AUCTIONS) == ["0:05robot_0: robot_0 (1.0, 3.0) at 3.0 · 1 of 2 to nobody yet"]
        assert await tab.run(said)

    asyncio.run(replayed(tmp_path, record, look))


# Places


def test_goal_lies_in_the_world_by_the_start_pose():
    robot = made_robot(start=Pose(10.0, 20.0, math.pi / 2.0), goals=(Goal(1.0, 2.0, 0.5, 3.0, "reached"),))
    (goal,) = replay_data.goals(robot)
    assert (goal["x"], goal["y"]) == pytest.approx((9.5, 22.0))


def test_goals_of_the_page_are_placed(record, page):
    for robot in embedded(page)["robots"]:
        start = record["robots"][robot["name"]]["start"]
        goal = record["robots"][robot["name"]]["goals"][0]
        turn = complex(math.cos(start[2]), math.sin(start[2]))
        place = complex(*start[:2]) + turn * complex(goal["x"], goal["y"])
        assert (robot["goals"][0]["x"], robot["goals"][0]["y"]) == pytest.approx((place.real, place.imag), abs=1e-3)


def test_picture_lies_in_the_world_by_the_start_pose():
    # 3 rows of 0.5 m: the upper left corner of the picture is at (-1, 0.5) in the map, a quarter turn makes (-0.5, -1).
    matrix = picture_to_world(Pose(10.0, 20.0, math.pi / 2.0), 0.5, (-1.0, -1.0), rows=3)
    a, b, c, d, e, f = matrix
    assert (e, f) == pytest.approx((9.5, 19.0))
    assert (a, b) == pytest.approx((0.0, 0.5))  # a column further right: along the map's x, the world's y
    assert (c, d) == pytest.approx((0.5, 0.0))  # a row further down: against the map's y, along the world's x


def test_walls_of_the_maps_lie_on_the_true_walls(record, page):
    walls = world_walls("small8x8")
    data = embedded(page)
    for view, (name, robot) in zip(data["views"], record["robots"].items(), strict=True):
        picture = decode_map(stored(record["maps"][name]["global"]), name)
        a, b, c, d, e, f = data["layers"][view["alone"]]["matrix"]
        rows, columns = np.nonzero(np.flipud(picture.classes) == OCCUPIED)
        x, y = a * (columns + 0.5) + c * (rows + 0.5) + e, b * (columns + 0.5) + d * (rows + 0.5) + f
        index = np.floor((np.stack([x, y], axis=-1) - walls.origin) / walls.resolution).astype(int)
        assert (walls.cells[index[:, 1], index[:, 0]] != 0).mean() > 0.99, robot["start"]


def test_everything_lies_within_the_bounds(page):
    data = embedded(page)
    left, bottom, right, top = data["bounds"]
    assert (left, bottom) == pytest.approx((-0.5, -0.5), abs=0.1)
    assert (right, top) == pytest.approx((8.5, 8.5), abs=0.1)


# Links, merges, events


def neighbors_of(**samples):
    return {
        name: made_robot(series=RobotSeries(time=(0.0, 1.0, 2.0, 3.0), neighbors=tuple(given)))
        for name, given in samples.items()
    }


def test_link_lasts_from_the_first_to_the_last_sample_with_it():
    robots = neighbors_of(a=[[], ["b"], ["b"], []], b=[[], ["a"], ["a"], []])
    assert replay_data.links(robots, 4.0) == [[1, 3, 0, 1, True]]


def test_link_that_only_one_knows_is_told_apart():
    robots = neighbors_of(a=[["b"], ["b"], [], []], b=[[], ["a"], ["a"], ["a"]])
    assert replay_data.links(robots, 4.0) == [[0, 1, 0, 1, False], [1, 2, 0, 1, True], [2, 4, 0, 1, False]]


def test_links_to_strangers_are_left_out():
    assert replay_data.links(neighbors_of(a=[["x"]] * 4), 4.0) == []


@pytest.mark.parametrize(
    ("merge", "kind"),
    [
        (Merge("b", 1.0, Pose(), right=True), "right"),
        (Merge("b", 1.0, Pose(), right=False), "wrong"),
        (Merge("b", 1.0, None), "revoked"),
        (Merge("b", 1.0, Pose()), "unknown"),
    ],
)
def test_kind_of_merge(merge, kind):
    assert replay_data.merge_kind(merge) == kind


def test_second_merge_is_an_adjustment_unless_revoked():
    merges = tuple(Merge("b", at, pose) for at, pose in ((1.0, Pose()), (2.0, Pose()), (3.0, None), (4.0, Pose())))
    found = replay_data.merges({"a": made_robot(merges=merges)})
    assert [merge["again"] for merge in found] == [False, True, True, False]


def test_events_tell_merges_failures_and_ends_in_order(page):
    events = embedded(page)["events"]
    assert [event["at"] for event in events] == sorted(event["at"] for event in events)
    texts = " / ".join(event["text"] for event in events)
    assert "robot_0 merged robot_1: right (0.05 m, 0.6° off)" in texts
    assert "robot_1 merged robot_0: WRONG" in texts
    assert "robot_0 failed to reach its goal: no path" in texts
    assert "robot_1 finished its exploration" in texts


def test_death_late_start_and_warnings_are_told(record):
    record = copy.deepcopy(record)
    record["robots"]["robot_1"]["died_at"] = 33.0
    record["trial"]["joins"] = {"0": 4.0}
    record["notes"] = [
        {"at": 7.0, "robot": "robot_0", "text": "odd", "warning": True},
        {"at": 8.0, "robot": "robot_0", "text": "usual", "warning": False},
    ]
    events = {(event["at"], event["kind"]): event["text"] for event in data_of(record)["events"]}
    assert events[33, "died"] == "robot_1 died"
    assert events[4, "joined"] == "robot_0 joined the team"
    assert events[7, "warning"] == "robot_0: odd"
    assert (8, "warning") not in events


def test_a_warning_that_comes_again_at_once_is_told_once(record):
    """Of a robot out of reach a mission had eighty lines `Exception thrown while processing service call`."""
    record = copy.deepcopy(record)
    text = "Exception thrown while processing service call: not delivered to robot_1"
    times = [("robot_0", 7.0), ("robot_0", 7.1), ("robot_1", 7.2), ("robot_0", 26.0), ("robot_0", 27.0)]
    record["notes"] = [{"at": at, "robot": robot, "text": text, "warning": True} for robot, at in times]
    told = [(event["at"], event["text"]) for event in data_of(record)["events"] if event["kind"] == "warning"]
    assert told == [
        (7, "robot_0: not delivered to robot_1 (3 times)"), (7.2, "robot_1: not delivered to robot_1"),
        (27, "robot_0: not delivered to robot_1"),
    ]  # fmt: skip


# Growth of maps


def room(size: int = 40, resolution: float = 0.1) -> Grid:
    """Walls around a square, and one across at half its height with nothing open."""
    cells = np.zeros((size, size), dtype=np.uint8)
    cells[[0, size // 2, -1], :] = 1
    cells[:, [0, -1]] = 1
    return Grid(cells, resolution, (0.0, 0.0))


def test_nothing_is_seen_through_walls():
    since = Lookout(room()).first_seen({"time": [3.0], "x": [2.0], "y": [1.0], "yaw": [0.0]}, Eye())
    assert np.isfinite(since[3:18, 3:37]).mean() > 0.99
    assert np.isinf(since[22:]).all()


def test_places_are_seen_when_the_robot_comes_near_enough():
    series = {"time": [0.0, 10.0], "x": [0.5, 3.0], "y": [1.0, 1.0], "yaw": [0.0, 0.0]}
    lookout = Lookout(room())
    near, far = lookout.at([lookout.first_seen(series, Eye(range_max=1.0))], np.array([[0.8, 1.0], [3.2, 1.0]]))[0]
    assert near == pytest.approx(0.0, abs=0.01)
    assert far == pytest.approx(10.0, abs=0.01)


def test_field_of_view_turns_with_the_robot():
    series = {"time": [0.0], "x": [2.0], "y": [1.0], "yaw": [math.pi]}
    lookout = Lookout(room())
    since = lookout.first_seen(series, Eye(field_of_view=math.radians(60.0)))
    ahead, behind = lookout.at([since], np.array([[1.0, 1.0], [3.0, 1.0]]))[0]
    assert math.isfinite(ahead) and math.isinf(behind)


def test_robot_at_rest_looks_around_once():
    poses = np.zeros((50, 3))
    assert viewpoints(poses) == [0]
    poses[20:, 2] = 2.0 * math.pi - 0.01  # the same heading
    assert viewpoints(poses) == [0]
    poses[30:, 0] = 1.0
    assert viewpoints(poses) == [0, 30]


def strip(*classes: int) -> Picture:
    return Picture(np.array([classes], dtype=np.uint8), 1.0, (0.0, 0.0))


def test_what_another_saw_is_known_from_the_merge_on():
    own, other = np.array([1.0, np.inf, np.inf]), np.array([5.0, 2.0, 9.0])
    since = known_since(strip(FREE, FREE, FREE), [(own, 0.0), (other, 6.0)])
    assert since.tolist() == [[1.0, 6.0, 9.0]]


def test_cells_that_nobody_saw_follow_their_neighbours():
    since = known_since(strip(FREE, FREE, FREE), [(np.array([4.0, np.inf, np.inf]), 0.0)])
    assert since.tolist() == [[4.0, 4.0, 4.0]]


def test_map_grows_no_faster_than_the_recorded_area():
    picture = strip(FREE, FREE, FREE, FREE)
    since = paced(picture, np.array([[0.0, 1.0, 0.0, 30.0]]), [0, 10, 20], [1.0, 2.0, 4.0])
    assert since.tolist() == [[0.0, 20.0, 10.0, 30.0]]


def test_reconstruction_is_complete_at_the_end_and_labelled(record, page):
    data = embedded(page)
    assert {layer["source"] for layer in data["layers"]} == {"reconstructed"}
    picture = strip(FREE, OCCUPIED, UNKNOWN)
    uri = timed_uri(picture, np.array([[600.0, 0.0, 7.0]]), 0.5)
    assert pixels_of(uri).tolist() == [[[FREE, 4, 176], [OCCUPIED, 0, 0], [UNKNOWN, 0, 0]]]
    for layer in data["layers"]:
        pixels = pixels_of(layer["png"]).astype(int)
        assert (pixels[..., 1] * 256 + pixels[..., 2]).max() * data["step"] <= data["end"]


def pixels_of(uri: str) -> np.ndarray:
    """RGB (rows, columns, 3) of a data URI."""
    data = np.frombuffer(base64.b64decode(uri.removeprefix("data:image/png;base64,")), dtype=np.uint8)
    return cv2.imdecode(data, cv2.IMREAD_COLOR)[..., ::-1]


def test_snapshots_are_shown_instead_when_there_are_some(record):
    data = data_of(add_snapshots(copy.deepcopy(record)))
    assert data["layers"] == []
    for frames in data["snapshots"]:
        assert [frame["time"] for frame in frames] == [0, 10, 20, 30, 40, 50, 60]


def test_final_map_ends_the_snapshots(record):
    record = add_snapshots(copy.deepcopy(record))
    record["snapshots"] = [frame for frame in record["snapshots"] if frame["time"] < 30]
    for frames in data_of(record)["snapshots"]:
        assert [frame["time"] for frame in frames] == [0, 10, 20, 60]


def test_snapshots_are_thinned_from_the_end():
    frames = [{"time": time} for time in range(10)]
    assert [frame["time"] for frame in thinned(frames, 4)] == [1, 5, 9]


def test_map_is_cut_to_what_is_known():
    classes = np.full((6, 8), UNKNOWN, dtype=np.uint8)
    classes[2:4, 3:7] = FREE
    part = cropped(Picture(classes, 0.5, (-1.0, 2.0)))
    assert part.classes.shape == (2, 4) and part.origin == (0.5, 3.0)


def test_coarser_map_keeps_walls():
    classes = np.full((4, 5), FREE, dtype=np.uint8)
    classes[0, 0] = OCCUPIED
    small = coarser(Picture(classes, 0.1, (0.0, 0.0)), 6)
    assert small.resolution == pytest.approx(0.2)
    assert small.classes.tolist() == [[OCCUPIED, FREE, FREE], [FREE, FREE, FREE]]


def test_coarser_walls_keep_their_place():
    picture = wall_picture(room(), 0.25)
    wall = picture.centres()[picture.classes.reshape(-1) == OCCUPIED]
    assert wall.min() == pytest.approx(0.125) and wall.max() == pytest.approx(3.875)


# Records that lack something


@pytest.mark.parametrize("part", ["maps", "versions", "snapshots"])
def test_parts_of_the_record_may_be_missing(record, part):
    record = {name: value for name, value in record.items() if name != part}
    data = embedded(page_of(record))
    assert [robot["name"] for robot in data["robots"]] == list(record["robots"])
    assert data["end"] == 60


@pytest.mark.parametrize("part", ["finished_at", "goals", "merges", "auctions", "series"])
@pytest.mark.parametrize("value", ["missing", None])
def test_parts_of_a_robot_may_be_missing(record, part, value):
    record = copy.deepcopy(record)
    for robot in record["robots"].values():
        robot.pop(part)
        if value is None:
            robot[part] = None
    assert len(embedded(page_of(record))["robots"]) == 2


@pytest.mark.parametrize("name", ["x", "explored", "own", "distance", "bytes", "state", "neighbors"])
def test_series_may_be_missing(record, name):
    record = copy.deepcopy(record)
    for robot in record["robots"].values():
        del robot["series"][name]
    series = embedded(page_of(record))["robots"][0]["series"]
    assert name not in series and "time" in series


def test_little_is_needed():
    data = page_data(made_mission([made_robot()]))
    assert data["robots"][0]["name"] == "robot_0"
    assert data["views"] == [{"team": None, "alone": None}]
    assert len(data["notes"]) >= 3


def test_without_maps_the_area_in_view_is_shown_and_labelled(record):
    data = data_of({**record, "maps": {}})
    assert [layer["source"] for layer in data["layers"]] == ["seen", "seen"]


def test_without_the_world_the_maps_stand_in_for_its_walls(record):
    record = copy.deepcopy(record)
    record["trial"]["world"] = "gone"
    data = data_of(record)
    assert data["walls"] is None
    assert len(data["layers"]) == 4
    assert "The world gone is not at hand: no true walls." in data["notes"]


def test_failed_trial_shows_reason_and_traceback(record):
    outcome = {"status": "failed", "reason": "ValueError: <no>", "time": 9.0, "traceback": "Traceback <here>"}
    team = {**record["team"], "exploration_time": None}
    data = embedded(page_of({**record, "outcome": outcome, "team": team}))
    assert data["outcome"] == {"status": "failed", "reason": "ValueError: <no>", "traceback": "Traceback <here>"}


def test_world_of_the_project_is_found():
    surroundings = load_surroundings("small8x8")
    assert surroundings is not None
    assert surroundings.eyes["robot_0"].range_max > 1.0 and surroundings.footprints["robot_0"]


# Damaged records


def damage(record, *path_and_value):
    record = copy.deepcopy(record)
    *path, key, value = path_and_value
    entry = record
    for name in path:
        entry = entry[name]
    entry[key] = value
    return record


@pytest.mark.parametrize(
    ("path_and_value", "culprit"),
    [
        (("maps", "robot_0", "global", "png", "AAAA"), '"maps.robot_0.global.png"'),
        (("maps", "robot_0", "local", "resolution", 0.0), '"maps.robot_0.local" lacks a resolution'),
    ],
)
def test_damage_is_named(record, path_and_value, culprit):
    with pytest.raises(ReplayError, match=re.escape(culprit)):
        page_of(damage(record, *path_and_value))


@pytest.mark.parametrize(
    ("content", "culprit"),
    [
        ([], "no record of a mission"),
        ({"format": 3, "robots": {"a": {}}}, "the record has format 3"),
        ({"format": 1, "robots": {}}, "trial is missing"),
        (document_of(made_mission([made_robot()], "failed")) | {"robots": {}}, "holds no robots"),
    ],
)
def test_other_files_are_refused(tmp_path, content, culprit):
    path = tmp_path / "other.json"
    path.write_text(json.dumps(content))
    with pytest.raises(ReplayError, match=f"other.json.*{culprit}"):
        load_record(path)


def test_a_folder_is_told_with_a_record_in_it(tmp_path):
    with pytest.raises(ReplayError, match=r"is a folder: give one of the records in it, which ends in \.json"):
        load_record(tmp_path)
    (tmp_path / "a.json").write_text("")
    with pytest.raises(ReplayError, match=re.escape(f"one of the records in it, as {tmp_path}/a.json")):
        load_record(tmp_path)
    (tmp_path / "record.json").write_text("")  # of a team, beside its plan
    with pytest.raises(ReplayError, match=re.escape(f"one of the records in it, as {tmp_path}/record.json")):
        load_record(tmp_path)


# The command


@pytest.fixture
def written(tmp_path, record) -> Path:
    path = tmp_path / "small8x8-r2-paper-7-s17.json"
    path.write_text(json.dumps(record))
    return path


def test_command_writes_beside_the_record(written, capsys, page):
    assert main([str(written)]) == 0
    out = written.with_suffix(".html")
    assert out.read_text(encoding="utf-8") == page
    assert str(out) in capsys.readouterr().out


def test_command_writes_where_it_is_told(written, tmp_path):
    assert main([str(written), "--out", str(tmp_path / "other.html")]) == 0
    assert (tmp_path / "other.html").is_file() and not written.with_suffix(".html").exists()


def test_record_is_read_as_written(written, record):
    assert load_record(written) == record_of_document(record)


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        ([], "RECORD"),
        (["missing.json"], "missing.json is not there; give a record that"),
        (["."], "is a folder: give one of the records"),
        (["{record}", "--out", "{record}"], "is the record itself"),
        (["{record}", "--out", "{folder}"], "is a folder"),
        (["{record}", "--out", "{folder}/none/page.html"], "does not exist"),
        (["{folder}/text.json"], "cannot be read as JSON"),
        (["{folder}/list.json"], "no record of a mission"),
        (["{record}", "--colour"], "--colour"),
    ],
)
def test_bad_call_gives_one_clear_line(written, capsys, arguments, culprit):
    folder = written.parent
    (folder / "text.json").write_text("not JSON")
    (folder / "list.json").write_text("[]")
    assert main([word.format(record=written, folder=folder) for word in arguments]) == 2
    output = capsys.readouterr()
    assert output.out == "" and output.err.count("\n") == 1
    assert output.err.startswith("show: ") and culprit in output.err


def test_script_runs(written):
    script = Path(__file__).resolve().parents[1] / "scripts" / "show"
    done = subprocess.run([sys.executable, str(script), str(written)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert written.with_suffix(".html").is_file()


def test_sample_maps_are_placed_right():
    """The sample itself: a robot's start is free, the walls around it are where they are."""
    walls = world_walls("small8x8")
    start = Pose(1.5, 2.0, 1.0)
    picture = decode_map(stored(map_around(walls, start, 2.0)), "sample")
    free = start.apply(picture.centres()[picture.classes.reshape(-1) == FREE])
    index = np.floor((free - walls.origin) / walls.resolution).astype(int)
    assert (walls.cells[index[:, 1], index[:, 0]] == 0).all()
