"""The worlds of the project: they can be loaded, robots start in the free, and no room is closed off."""

import math
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
from scipy import ndimage

from mr_sim.world import World
from mr_sim.world_model import load_world
from mr_sim.worlds import WorldNotFoundError, find_world, warning_of

WORLDS = {
    "office26x15": 16, "office26x15_mixed": 16, "office26x15_turtlebots": 16, "small8x8": 4, "narrow": 16,
    "equalrooms26x15": 16, "large60x60": 16, "cave26x18": 16, "hall30x20": 16, "loop30x20": 16, "office40x22": 16,
}  # fmt: skip
SIZES = {
    "office26x15": (26, 15), "small8x8": (8, 8), "narrow": (15, 12), "equalrooms26x15": (26, 15),
    "large60x60": (60, 60), "cave26x18": (26, 18), "hall30x20": (30, 20), "loop30x20": (30, 20),
    "office40x22": (40, 22),
}  # m  # fmt: skip
WAY = 0.25  # m that a robot's middle keeps from walls on its way
GENERATOR = Path(__file__).parents[4] / "tools" / "make_worlds"


@pytest.fixture(scope="module", params=sorted(WORLDS))
def world(request) -> World:
    return World(load_world(find_world(request.param)))


def name_of(world: World) -> str:
    return world.description.path.stem


def passable(world: World) -> np.ndarray:
    """Cells, bool (rows, columns), in which a robot's middle may be on its way."""
    grid = world.obstacles
    return ndimage.distance_transform_edt(grid.cells == 0) * grid.resolution - grid.resolution / 2.0 >= WAY


def cell_of(world: World, x: float, y: float) -> tuple:
    column, row = np.floor((np.array((x, y)) - world.obstacles.origin) / world.obstacles.resolution).astype(int)
    return row, column


def test_every_world_is_among_these():
    folder = find_world("small8x8").parent
    assert {path.stem for path in folder.glob("*.world")} == set(WORLDS)


@pytest.mark.skipif(not GENERATOR.is_file(), reason="installed without docs/")
def test_every_world_has_a_picture_in_the_docs():
    docs = GENERATOR.parents[1] / "docs"
    page = (docs / "worlds.md").read_text(encoding="utf-8")
    assert all(f"`{name}`" in page or f"## {name}\n" in page for name in WORLDS)
    assert all((docs / "images" / "worlds" / f"{name}.png").is_file() for name in SIZES)


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("smal8x8", 'no world "smal8x8", did you mean "small8x8"?'),
        ("smal8x8.world", 'no world "smal8x8.world", did you mean "small8x8"?'),
        ("/tmp/nope.yaml", 'no world "/tmp/nope.yaml": there is no such file'),
        ("none.yaml", 'no world "none.yaml": there is no such file'),
        ("/", 'no world "/": that is a folder'),
        ("elsewhere", 'no world "elsewhere": give the path of a .world file or'),
    ],
)
def test_a_world_that_is_not_there_is_told_with_what_was_meant(name, told):
    with pytest.raises(WorldNotFoundError) as caught:
        find_world(name)
    assert str(caught.value).startswith(told)


def test_robots_and_size(world):
    assert world.names == tuple(f"robot_{i}" for i in range(WORLDS[name_of(world)]))
    assert all(len(robot.rangers) == 1 for robot in world.robots)
    rows, columns = world.obstacles.cells.shape
    size = SIZES[name_of(world).split("_")[0]]
    assert (columns * world.obstacles.resolution, rows * world.obstacles.resolution) == pytest.approx(size)
    edge = np.concatenate([world.obstacles.cells[[0, -1]].ravel(), world.obstacles.cells[:, [0, -1]].ravel()])
    assert edge.all(), "closed all around"


def test_no_robot_starts_in_a_wall_or_in_reach_of_another(world):
    outlines = []
    for index, robot in enumerate(world.robots):
        assert world.core.contact_at(index, robot.start) == 0
        outlines.append(np.concatenate([robot.start.apply(np.array(polygon)) for polygon in robot.footprint]))
    for index, outline in enumerate(outlines):
        for other in outlines[:index]:
            assert np.hypot(*(outline[:, None] - other[None]).T).min() > 0.25


def test_team_starts_together_and_may_reach_everything(world):
    labels, parts = ndimage.label(passable(world))
    starts = {int(labels[cell_of(world, *robot.start[:2])]) for robot in world.robots}
    assert len(starts) == 1 and 0 not in starts
    areas = np.bincount(labels.ravel())[1:] * world.obstacles.resolution**2
    assert areas.max() > 0.999 * areas.sum(), f"{parts} parts of {np.sort(areas)} m^2"


def test_narrow_world_lets_one_robot_through_and_not_two():
    world = World(load_world(find_world("narrow")))
    grid = world.obstacles
    width = 2.0 * ndimage.distance_transform_edt(grid.cells == 0) * grid.resolution
    labels, _ = ndimage.label(passable(world))
    # What two robots side by side need, 0.38 m each and 0.05 m around them, cuts the world into its rooms.
    _, rooms = ndimage.label((labels > 0) & (width > 2 * 0.38 + 3 * 0.05))
    assert rooms >= 15


def test_equal_rooms_are_copies_and_the_floor_looks_the_same_turned():
    cells = World(load_world(find_world("equalrooms26x15"))).obstacles.cells
    assert np.array_equal(cells, np.rot90(cells, 2))
    pitch, first = 102, 4  # cells of 0.05 m
    room = cells[:124, first : first + 104]  # 6.2 m x 5.2 m with its walls
    assert room[2:-2, 2:-2].any(), "furnished"
    for left in range(first, first + 5 * pitch, pitch):
        assert np.array_equal(cells[:124, left : left + 104], room)
    assert np.count_nonzero(room[-1] == 0) >= 0.9 / 0.05, "a door wide enough"


def test_sensors_of_the_teams():
    fields = {name: [robot.rangers[0].field_of_view for robot in World(load_world(find_world(name))).robots]
              for name in ("office26x15", "office26x15_turtlebots", "office26x15_mixed")}  # fmt: skip
    laser, kinect = math.radians(270), math.radians(57)
    assert fields["office26x15"] == pytest.approx([laser] * 16)
    assert fields["office26x15_turtlebots"] == pytest.approx([kinect] * 16)
    assert fields["office26x15_mixed"] == pytest.approx([laser, kinect] * 8)


def test_turtlebot():
    robot = load_world(find_world("office26x15_turtlebots")).robots[0]
    (ranger,) = robot.rangers
    assert (ranger.range_min, ranger.range_max, ranger.noise_share) == (0.45, 4.0, 0.01)
    corners = np.array(robot.footprint[0])
    assert np.hypot(*corners.T) == pytest.approx(np.full(12, 0.177), abs=1e-3), "round, 0.354 m across"


def test_start_poses_of_the_office():
    starts = [robot.start for robot in load_world(find_world("office26x15.world")).robots]
    assert starts[:6] == [(1, 14.3, 0), (1, 13.4, 0), (2, 14.3, 0), (2, 13.4, 0), (3, 14.3, 0), (3, 13.4, 0)]


@pytest.mark.skipif(not GENERATOR.is_file(), reason="installed without tools/")
def test_pictures_are_those_of_their_generator(tmp_path):
    subprocess.run([sys.executable, str(GENERATOR), str(tmp_path)], check=True)
    made = sorted(path.name for path in tmp_path.iterdir())
    generated = ["cave26x18", "hall30x20", "loop30x20", "office40x22"]
    pictures = sorted(f"{name}.png" for name in (*generated, "equalrooms26x15", "large60x60", "narrow"))
    assert made == sorted([*pictures, *(f"{name}.world" for name in generated)])
    for name in generated:
        assert (tmp_path / f"{name}.world").read_text() == find_world(name).read_text(), f"{name}: run make_worlds"
    for name in pictures:
        kept = cv2.imread(str(find_world(name.replace(".png", "")).parent / name), cv2.IMREAD_GRAYSCALE)
        assert np.array_equal(cv2.imread(str(tmp_path / name), cv2.IMREAD_GRAYSCALE), kept), f"{name}: run make_worlds"


def test_only_worlds_of_others_give_a_warning(tmp_path):
    own = find_world("office26x15")
    description = load_world(own)
    assert description.warning and warning_of("office26x15", description) == ""
    (tmp_path / "mine.world").write_text('position ( ctrl "wander" )')
    mine = str(tmp_path / "mine.world")
    assert warning_of(mine, load_world(mine)) == f"{mine}: without effect here: words ctrl"
