"""Moving pictures of recorded missions, and the one that the README begins with."""

import io
import os
from pathlib import Path

import pytest
from PIL import Image
from replay_sample import sample_record
from test_replay import record_of_document

from mr_experiments.replay.movie import REST, Film, make_movie, moving
from mr_experiments.replay.movie_command import main
from mr_page.browser import program

ROOT = Path(__file__).resolve().parents[3]
NEEDS_BROWSER = pytest.mark.skipif(
    program() is None and not os.environ.get("REQUIRE_BROWSER"),
    reason="no headless Chromium: run tools/install_dependencies browser",
)


def durations(movie):
    result = []
    for number in range(movie.n_frames):
        movie.seek(number)
        result.append(movie.info["duration"])
    return result


def changed(one, other):
    """Share of pixels."""
    pairs = list(zip(one.convert("RGB").getdata(), other.convert("RGB").getdata(), strict=True))
    return sum(before != after for before, after in pairs) / len(pairs)


def shown(movie, number):
    movie.seek(number)
    return movie.convert("RGB")


def test_a_film_begins_and_ends_with_the_mission():
    film = Film(width=700, seconds=2.0, rate=4)
    times = film.times(70.0)
    assert (len(times), times[0], times[1], times[-1]) == (8, 0.0, 10.0, 70.0)
    assert film.height([0.0, 0.0, 20.0, 10.0]) == 350


def test_pictures_become_one_that_moves():
    pictures = [Image.new("RGB", (40, 30), colour) for colour in ("red", "white", "black")]
    movie = Image.open(io.BytesIO(moving(pictures, rate=10)))
    assert durations(movie) == [100, 100, REST] and movie.info["loop"] == 0
    assert [shown(movie, number).getpixel((5, 5)) for number in range(3)] == [(255, 0, 0), (255, 255, 255), (0, 0, 0)]


@NEEDS_BROWSER
def test_a_mission_is_seen_to_go_on():
    film = Film(width=300, seconds=1.0, rate=4)
    movie = Image.open(io.BytesIO(make_movie(record_of_document(sample_record()), film)))
    assert movie.n_frames == 4 and movie.width == 300
    first, last = shown(movie, 0), shown(movie, 3)
    assert 0.02 < changed(first, last) < 0.98  # maps and ways grow; what is unknown or outside stays


@pytest.mark.parametrize(
    "words, culprit",
    [
        (["--width", "50"], "--width 50 is not within 200 to 2000"),
        (["--seconds", "0"], "--seconds 0 is not within 1 to 120"),
        (["--rate", "100"], "--rate 100 is not within 1 to 25"),
        ([], "no_such.json"),
    ],
)
def test_bad_calls_are_one_line(tmp_path, capsys, words, culprit):
    assert main([str(tmp_path / "no_such.json"), *words]) == 2
    error = capsys.readouterr().err
    assert error.startswith("movie: ") and culprit in error and error.count("\n") == 1


def test_the_readme_begins_with_a_moving_picture():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    path = ROOT / text[text.index("](") + 2 : text.index(")", text.index("]("))]
    movie = Image.open(path)
    assert path.stat().st_size <= 2_000_000 and movie.width <= 800
    assert 8.0 <= sum(durations(movie)) / 1000.0 <= 15.0
    assert changed(shown(movie, 0), shown(movie, movie.n_frames - 1)) > 0.2
