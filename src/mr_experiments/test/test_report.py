"""The report as a reader gets it: one page that needs nothing else, the figures, the tables and the command."""

import csv
import xml.etree.ElementTree as ElementTree
from html.parser import HTMLParser

import cv2
import numpy as np
import pytest
from sample_records import failed_record, make_record, write_random_set, write_record

from mr_experiments.report import paper
from mr_experiments.report.figures import finishing_curve, mean_progress, progress_figure, reference_area
from mr_experiments.report.map_figure import load_maps, map_figure, overlay, shrunk, typical_record
from mr_experiments.report.record_set import load_record, load_records
from mr_experiments.report.report import make_report
from mr_experiments.report.report_command import main
from mr_experiments.report.scope import scopes
from mr_experiments.report.time_axis import DETAIL, TimeAxis

VOID = {"meta", "br", "link", "img", "hr"}


class Page(HTMLParser):
    """What a page refers to, its texts, its tables, and whether its elements are closed."""

    def __init__(self, text):
        super().__init__()
        self.references, self.ids, self.open, self.tables, self.words = [], [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("src", "href", "xlink:href", "data", "poster", "srcset"):
                self.references.append(value)
            if name == "id":
                self.ids.append(value)
        if tag not in VOID:
            self.open.append(tag)
        if tag == "table":
            self.tables.append([])
        if tag == "tr":
            self.tables[-1].append([])
        if tag in ("td", "th"):
            self.tables[-1][-1].append("")

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.handle_endtag(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)
        if self.open and self.open[-1] in ("td", "th"):
            self.tables[-1][-1][-1] += data

    def rows(self, *beginning):
        return [row for table in self.tables for row in table if row[: len(beginning)] == list(beginning)]


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("set")
    write_random_set(folder / "records", trials=4, world=paper.WORLD, limit=300.0)
    return make_report(folder / "records", folder / "out", with_bound=False)


@pytest.fixture(scope="module")
def text(made):
    return made.page.read_text()


def test_the_page_needs_nothing_else(text):
    page = Page(text)
    assert page.open == []
    assert page.references
    assert all(reference.startswith(("#", "data:")) for reference in page.references)
    assert "@import" not in text and "<script" not in text
    assert text.count("url(") == text.count("url(#")
    assert len(page.ids) == len(set(page.ids))
    links = [reference[1:] for reference in page.references if reference.startswith("#")]
    assert set(links) <= set(page.ids)


def test_all_figures_are_in_and_beside(made, text):
    assert sorted(path.name for path in made.figures) == [
        "office26x15-paper-7-coverage.png",
        "office26x15-paper-7-fig3-map.png",
        "office26x15-paper-7-fig4-progress.png",
        "office26x15-paper-7-fig5-finishing.png",
    ]
    pictures = [part.split("</svg>")[0] + "</svg>" for part in text.split("<figure>")[1:]]
    assert len(pictures) == 4
    for picture in pictures:
        assert ElementTree.fromstring(picture).tag.endswith("svg")
        assert "currentColor" in picture
    for path in made.figures:
        image = cv2.imread(str(path))
        assert image.shape[1] > 1000 and image.std() > 10


def test_trials_that_did_not_finish_are_counted_and_named(text):
    page = Page(text)
    assert "16 missions: 14 finished, 1 unfinished, 1 failed" in text
    assert page.rows(paper.WORLD, "paper", "7", "bias", "3") == [
        [paper.WORLD, "paper", "7", "bias", "3", "4", "3", "0", "1"],
        [paper.WORLD, "paper", "7", "bias", "3", "2", "failed", "12.5", "map_merger: IndexError at 12.5 s"],
    ]
    assert ["4", "unfinished"] in [[row[4], row[6]] for row in page.rows(paper.WORLD) if row[5] == "3"]


def test_numbers_on_the_page_and_in_the_tables(tmp_path):
    for seed, end in ((1, 100.0), (2, 120.0), (3, 140.0)):
        values = {"times": [90.0, end], "distances": [30.0, 40.0], "errors": [-1.0, 2.0]}
        write_record(tmp_path / "records", make_record(2, seed, **values, world=paper.WORLD, with_maps=False))
    report = make_report(tmp_path / "records", tmp_path / "out", with_bound=False)
    rows = Page(report.page.read_text()).rows("2", "3", "0", "0")
    assert [row[4:7] for row in rows] == [["70.0", "70.0", "70.0"], ["102.0", "120.0", "138.0"]]
    assert [row[9:] for row in rows] == [["93", "121", "157"], ["649", "783", "942"]]
    with (tmp_path / "out" / "tables" / "table2b_exploration_time.csv").open() as file:
        (row,) = csv.DictReader(file)
    assert (row["robots"], float(row["exploration_time_s_mean"])) == ("2", 120.0)
    assert float(row["paper_exploration_time_s_mean"]) == 783


def test_a_set_of_failures_only_has_a_report_and_text_is_escaped(tmp_path):
    write_record(tmp_path, failed_record(1, 2, "<script>alert('&')</script>"))
    page = make_report(tmp_path, tmp_path / "out", with_bound=False).page.read_text()
    assert "1 failed" in page
    assert "<script>" not in page and "&lt;script&gt;" in page


def test_an_unknown_world_only_costs_the_bound(tmp_path):
    write_record(tmp_path, make_record(1, 1, world="nowhere", with_maps=False))
    report = make_report(tmp_path, tmp_path / "out")
    assert any("No lower bound" in note and "nowhere" in note for note in report.notes)


def test_progress_is_a_mean_over_the_reference_area(tmp_path):
    for seed, area in ((1, 40.0), (2, 44.0), (3, 60.0)):
        write_record(tmp_path, make_record(1, seed, times=[100.0 * seed], area=area))
    write_record(tmp_path, make_record(2, 1, area=99.0))
    (scope,) = scopes(load_records(tmp_path))
    assert reference_area(scope) == pytest.approx(44.0)
    times, shares = mean_progress(scope.results(1), 44.0)
    assert (times[0], times[-1]) == (0.0, 300.0)
    assert shares[-1] == pytest.approx((40 + 44 + 60) / 3 / 44, rel=1e-4)
    assert (np.diff(shares) >= -1e-9).all()


def test_robots_that_never_finish_keep_the_curve_below_one(tmp_path):
    write_record(tmp_path, make_record(2, 1, times=[90.0, 100.0]))
    write_record(tmp_path, make_record(2, 2, times=[95.0, None], status="unfinished", reason="limit"))
    write_record(tmp_path, failed_record(2, 3, "IndexError"))
    times, shares = finishing_curve(load_records(tmp_path).records, 2)
    assert times.tolist() == [0.0, 90.0, 95.0, 100.0]
    assert shares == pytest.approx([0.0, 1 / 6, 2 / 6, 3 / 6])


def vertical_lines(figure):
    lines = [line for line in figure.axes[0].lines if len(set(line.get_xdata())) == 1 and len(line.get_xdata()) == 2]
    return {(line.get_linestyle(), float(line.get_xdata()[0])) for line in lines}


def test_mean_times_of_set_and_paper_are_marked(tmp_path):
    for seed, end in ((1, 100.0), (2, 140.0)):
        write_record(tmp_path / "paper", make_record(1, seed, times=[end], world=paper.WORLD))
        write_record(tmp_path / "other", make_record(1, seed, times=[end]))
    (scope,) = scopes(load_records(tmp_path / "paper"))
    assert vertical_lines(progress_figure(scope)) == {("-", 120.0), (":", 945.0)}
    (scope,) = scopes(load_records(tmp_path / "other"))
    assert vertical_lines(progress_figure(scope)) == {("-", 120.0)}


def test_time_axis():
    assert not TimeAxis.showing(100.0, 120.0).bent
    axis = TimeAxis.showing(100.0, 1000.0)
    assert axis.position(np.array([0.0, 50.0, 100.0, 1000.0])) == pytest.approx([0.0, DETAIL / 2, DETAIL, 1.0])
    assert axis.time(axis.position(np.array([30.0, 500.0]))) == pytest.approx([30.0, 500.0])


def test_maps_lie_at_the_true_start_poses(tmp_path):
    record = make_record(3, 1)
    maps = load_maps(load_record(write_record(tmp_path, record)))
    assert maps.owner == "robot_0"
    assert sorted(maps.local) == ["robot_0", "robot_2"]  # the sample leaves out the robot that is turned
    probes = np.array([(0.05, 3.0), (4.05, 1.0), (4.05, 5.0), (2.0, 2.0), (-0.5, 3.0)])
    assert maps.merged.at(probes).tolist() == [0, 0, 254, 254, 205]
    # What robot_2 knows begins 0.5 m before the last third of the room.
    assert maps.local["robot_2"].at(np.array([(4.7, 3.0), (4.9, 3.0)])).tolist() == [205, 254]


def test_a_turned_robot_is_turned_back(tmp_path):
    record = make_record(1, 1)
    record["robots"]["robot_0"]["start"] = [3.0, 1.0, np.pi / 2]
    maps = load_maps(load_record(write_record(tmp_path, record)))
    # In its map frame the left wall is at x = -1; turned by 90 degrees that is y = 0 in the world.
    probes = np.array([(3.0, 0.05), (3.0, 1.0), (3.0, 8.5), (-1.5, 1.0), (7.0, 1.0)])
    assert maps.merged.at(probes).tolist() == [0, 254, 205, 254, 205]
    low_x, high_x, low_y, high_y = overlay(maps)[1]
    assert high_y - low_y > high_x - low_x


def test_the_overlay_tints_what_local_maps_know(tmp_path):
    picture, (left, _, bottom, _) = overlay(load_maps(load_record(write_record(tmp_path, make_record(3, 1)))))

    def colour(x, y):
        return picture[int((y - bottom) / 0.05), int((x - left) / 0.05)]

    assert colour(4.0, 4.5) == pytest.approx([1.0, 1.0, 1.0])  # known to nobody's local map
    assert colour(1.0, 4.5)[0] < colour(1.0, 4.5)[2]  # robot_0 is blue
    assert colour(4.05, 1.0).max() < 0.3  # wall
    assert np.ptp(colour(-0.3, 3.0)) < 0.1  # outside


def test_thin_walls_survive_in_large_pictures():
    picture = np.ones((1000, 2001, 3))
    picture[:, 1234] = 0.1
    small = shrunk(picture)
    assert small.shape == (334, 667, 3)
    assert (small.min(axis=(1, 2)) == 0.1).all()


def test_the_map_shown_is_a_typical_one(tmp_path):
    for seed, error in ((1, 0.1), (2, -9.0), (3, 1.0)):
        write_record(tmp_path, make_record(2, seed, errors=[error, 0.0]))
    records = load_records(tmp_path)
    assert typical_record(records.records).asked.seed == 3
    (scope,) = scopes(records)
    assert "seed 3" in map_figure(scope).axes[0].get_title(loc="left")


def test_the_command(tmp_path, capsys):
    write_random_set(tmp_path / "now", trials=2, with_maps=False)
    write_random_set(tmp_path / "before", trials=2, generator_seed=2, with_maps=False)
    arguments = [str(tmp_path / "now"), "--against", str(tmp_path / "before"), "--no-bound"]
    assert main(arguments) == 0
    shown = capsys.readouterr().out
    assert "Table II b" in shown and "IndexError" in shown and "too few pairs (2 of 6)" in shown
    page = tmp_path / "now" / "report" / "report.html"
    assert page.name in shown
    assert 'id="comparison"' in page.read_text()
    assert (tmp_path / "now" / "report" / "tables" / "comparison.csv").exists()


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        (["{}/nowhere"], "nowhere is no folder"),
        (["{}"], "holds no records"),
        ([], "RECORDS"),
        (["{}", "--against"], "--against"),
        (["{}", "--across", "strategy"], "--across needs --against"),
        (["{}", "--against", "{}", "--across", "colour"], "colour"),
        (["{}", "--colour"], "--colour"),
    ],
)
def test_bad_calls_name_the_culprit(tmp_path, capsys, arguments, culprit):
    assert main([argument.format(tmp_path) for argument in arguments]) == 2
    assert culprit in capsys.readouterr().err


def test_help(capsys):
    with pytest.raises(SystemExit) as left:
        main(["--help"])
    assert left.value.code == 0
    assert "--against" in capsys.readouterr().out


def test_one_mission_is_one_mission(tmp_path):
    write_record(tmp_path, make_record(2, 1, with_maps=False))
    page = make_report(tmp_path, tmp_path / "out", with_bound=False).page.read_text()
    assert "1 mission: 1 finished" in page
