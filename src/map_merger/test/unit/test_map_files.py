"""Maps in files: what map_server would read is read, and everything else gets one line with the file's name."""

import math
import os
import re

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from map_merger.grid import Grid, GridInfo
from map_merger.map_files import MapFileError, read_map, write_map
from mr_grid import Pose

GOOD = {
    "image": "map.pgm",
    "resolution": 0.05,
    "origin": "[-1.0, 2.5, 0.3]",
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}
PIXELS = np.array([[0, 254, 205], [100, 50, 230]], np.uint8)
P5 = b"P5\n# CREATOR: map_saver.cpp 0.050 m/pix\n3 2\n255\n"


GOOD_PICTURE = P5 + PIXELS.tobytes()


def files(folder, picture=GOOD_PICTURE, name="map.pgm", **changes):
    """A map's files with changed keys (None = left out); the path of the .yaml file."""
    keys = {**GOOD, "image": name, **changes}
    (folder / "map.yaml").write_text("".join(f"{key}: {value}\n" for key, value in keys.items() if value is not None))
    if picture is not None:
        (folder / name).write_bytes(picture)
    return str(folder / "map.yaml")


def test_the_first_row_of_the_picture_is_the_highest_and_the_thresholds_are_those_of_the_file(tmp_path):
    grid = read_map(files(tmp_path))
    assert grid.info == GridInfo(3, 2, 0.05, Pose(-1.0, 2.5, 0.3))
    # occupancy: 1 - pixel / 255. Lower row: 0.61, 0.80, 0.10; upper row: 1.0, 0.004, 0.196.
    assert grid.cells.tolist() == [[-1, 100, 0], [100, 0, -1]]


def test_other_modes_and_negated_pictures_are_read_as_map_server_does(tmp_path):
    scaled = read_map(files(tmp_path, mode="scale")).cells
    assert scaled[0].tolist() == [int(99 * (155 / 255 - 0.196) / (0.65 - 0.196)), 100, 0]
    assert read_map(files(tmp_path, negate=1)).cells[1].tolist() == [0, 100, 100]
    raw = P5 + bytes([0, 100, 255, 101, 50, 1])
    assert read_map(files(tmp_path, raw, mode="raw")).cells.tolist() == [[-1, 50, 1], [0, 100, -1]]


def test_the_same_map_as_text_and_as_png_is_the_same(tmp_path):
    binary = read_map(files(tmp_path)).cells
    text = b"P2 3 2 255\n" + b" ".join(b"%d" % value for value in PIXELS.ravel()) + b"\n"
    assert np.array_equal(read_map(files(tmp_path, text)).cells, binary)
    for colours in (PIXELS, np.dstack([PIXELS] * 3), np.dstack([PIXELS] * 3 + [np.full_like(PIXELS, 255)])):
        png = cv2.imencode(".png", colours)[1].tobytes()
        assert np.array_equal(read_map(files(tmp_path, png, "map.png")).cells, binary)


def test_transparent_pixels_are_unknown(tmp_path):
    png = cv2.imencode(".png", np.dstack([PIXELS] * 3 + [np.zeros_like(PIXELS)]))[1].tobytes()
    assert (read_map(files(tmp_path, png, "map.png")).cells == -1).all()


@given(
    st.integers(1, 40),
    st.integers(1, 40),
    st.floats(0.01, 1.0),
    st.tuples(st.floats(-1e4, 1e4), st.floats(-1e4, 1e4), st.floats(-math.pi, math.pi)),
    st.integers(0, 2**32 - 1),
)
def test_what_is_written_is_read_again(tmp_path_factory, rows, columns, resolution, pose, seed):
    cells = np.random.default_rng(seed).choice(np.array([-1, 0, 100], np.int8), (rows, columns))
    grid = Grid(GridInfo(columns, rows, resolution, Pose(*pose)), cells)
    stem = str(tmp_path_factory.mktemp("map") / "yes: a map")
    picture, text = write_map(stem, grid)
    again = read_map(text)
    assert np.array_equal(again.cells, grid.cells)
    assert again.info.resolution == pytest.approx(resolution, abs=1e-9)
    assert again.info.origin == pytest.approx(pose, abs=1e-8)
    assert sorted(os.listdir(os.path.dirname(stem))) == sorted(map(os.path.basename, (picture, text)))


@pytest.mark.parametrize("key", sorted(GOOD))
def test_a_missing_key_is_named(tmp_path, key):
    path = files(tmp_path, **{key: None}) if key != "image" else files(tmp_path)
    if key == "image":
        with open(path, "w", encoding="utf-8") as file:
            file.write("resolution: 0.05\n")
    with pytest.raises(MapFileError, match=f"map.yaml: {key} is missing"):
        read_map(path)


@pytest.mark.parametrize(
    "changes, problem",
    [
        ({"resolution": -0.05}, "resolution must be a number of at least 0, not -0.05"),
        ({"resolution": 0}, "resolution of a grid must be"),
        ({"resolution": "fine"}, "resolution must be a number"),
        ({"resolution": ".nan"}, "resolution must be a number"),
        ({"resolution": "true"}, "resolution must be a number"),
        ({"origin": "[0, .inf, 0]"}, "origin must be a number"),
        ({"origin": "[0, 1e9, 0]"}, "origin must be a number from -100000 to 100000"),
        ({"origin": "[0, 0]"}, "origin must be"),
        ({"origin": "here"}, "origin must be"),
        ({"negate": 2}, "negate must be 0 or 1"),
        ({"negate": "[1]"}, "negate must be 0 or 1"),
        ({"occupied_thresh": 1.5}, "occupied_thresh must be a number from 0 to 1"),
        ({"free_thresh": 0.7}, "free_thresh must be less than occupied_thresh"),
        ({"mode": "grey"}, "mode must be one of trinary, scale, raw"),
        ({"mode": "[raw]"}, "mode must be one of"),
    ],
)
def test_a_bad_value_is_named_with_the_file(tmp_path, changes, problem):
    refused(files(tmp_path, **changes), "map.yaml", problem)


@pytest.mark.parametrize(
    "name, picture, problem",
    [
        ("map.pgm", None, "No such file"),
        ("map.pgm", GOOD_PICTURE[:-1], "cut off"),
        ("map.pgm", b"P2 3 2 255\n0 1 2 3", "cut off"),
        ("map.pgm", b"P2 3 2 255\n0 1 x 3 4 5", "cut off"),
        ("map.pgm", b"P5 100000 100000 255\n", "a map of 100000 x 100000 cells is not accepted"),
        ("map.pgm", b"P5 0 4 255\n", "0 x 4 cells"),
        ("map.pgm", b"P5 3 2 65535\n" + bytes(12), "grey values up to 255"),
        ("map.pgm", b"P5 three two 255\n", "not a picture"),
        ("map.pgm", b"P5" + b" " * 5000, "not a picture"),
        ("map.pgm", b"", "not a picture"),
        ("map.png", cv2.imencode(".png", PIXELS)[1].tobytes()[:-20], "cut off"),
        ("map.png", cv2.imencode(".png", PIXELS)[1].tobytes()[:10], "not a picture|cut off"),
        ("map.png", cv2.imencode(".png", PIXELS)[1].tobytes().replace(b"IDAT", b"IDAU"), "checksum"),
        ("map.png", cv2.imencode(".png", PIXELS.astype(np.uint16))[1].tobytes(), "8 bits"),
    ],
)
@pytest.mark.filterwarnings("ignore:string or file could not be read")
def test_a_bad_picture_is_named(tmp_path, capfd, name, picture, problem):
    refused(files(tmp_path, picture, name), name, problem)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "content",
    [b"just text", b"- a\n- b\n", b"", b"a: [", b"\xff\xfe\x00", b"x: " + b"[" * 5000, b"\x00", b" " * 200_000],
)
def test_what_is_no_description_is_refused(tmp_path, content):
    (tmp_path / "map.yaml").write_bytes(content)
    refused(str(tmp_path / "map.yaml"), "map.yaml", "")


def test_a_folder_is_no_map(tmp_path):
    refused(str(tmp_path), tmp_path.name, "directory")


@given(st.booleans(), st.integers(0, 10**6), st.binary(max_size=8), st.integers(0, 8))
def test_damaged_files_give_a_map_or_one_line(tmp_path_factory, in_picture, where, bytes_in, bytes_out):
    folder = tmp_path_factory.mktemp("damaged")
    path = files(folder)
    damaged = folder / ("map.pgm" if in_picture else "map.yaml")
    data = damaged.read_bytes()
    where %= len(data) + 1
    damaged.write_bytes(data[:where] + bytes_in + data[where + bytes_out :])
    try:
        grid = read_map(path)
    except MapFileError as error:
        assert "\n" not in str(error) and "map." in str(error)
    else:
        assert set(np.unique(grid.cells)) <= set(range(-1, 101))


def refused(path, name, problem):
    with pytest.raises(MapFileError) as caught:
        read_map(path)
    text = str(caught.value)
    assert name in text and re.search(problem, text) and "\n" not in text and len(text) < 500
