"""The benchmark of decisions on a small floor: what it measures, and that the team that is played explores."""

import json

import pytest

from mr_experiments.bench import bench_decisions
from mr_experiments.bench.scripted_team import ScriptedTeam
from mr_experiments.trial.trial_world import description_of

SMALL = (26.0, 15.0)
ROBOT = description_of(bench_decisions.WORLD).robots[0]


def test_team_sees_more_and_more_until_all_is_seen():
    team = ScriptedTeam("office", 7, SMALL, 3, ROBOT)
    shares = [team.known]
    while team.drive(1.0):
        shares.append(team.known)
    assert shares == sorted(shares) and len(shares) > 30
    cells = team.map().cells
    assert shares[0] < 0.3 and shares[-1] > 0.7 and (cells >= 0).mean() == shares[-1]
    assert team.map().info.resolution == 0.05 and cells.max() == 100


def test_each_map_is_a_step_in_which_the_agent_decides():
    bench = bench_decisions.Bench(ScriptedTeam("office", 7, SMALL, 4, ROBOT), 7)
    bench.stage(3)
    assert (len(bench.first), len(bench.maps), len(bench.between)) == (1, 3, 4 * 9)
    assert bench._agent.goal is not None and bench._agent.counters.maps == 4
    assert bench._agent.counters.auctions_completed > 0


def test_rows(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(bench_decisions, "SIZE", SMALL)
    monkeypatch.setattr(bench_decisions, "SHARES", (0.2,))
    out = tmp_path / "new" / "rows.json"
    code = bench_decisions.main(["--maps", "2", "--out", str(out)])
    rows = json.loads(out.read_text())
    assert code == (0 if all(row["holds"] for row in rows) else 1)
    assert [row["bar"] for row in rows] == ["<= 60", "<= 200", "<= 200", "<= 200"]
    assert all(row["value"] > 0.0 and row["unit"] == "ms" for row in rows)
    assert "8 robots" in rows[0]["what"] and "2 steps" in rows[0]["detail"]
    assert len(capsys.readouterr().out.splitlines()) == 4


def test_bar_that_is_missed(capsys):
    assert not bench_decisions.row("decision", 60.0, [10.0, 90.0], 90.0)["holds"]
    assert capsys.readouterr().out.startswith("MISS decision: 90 ms")
    with pytest.raises(SystemExit):
        bench_decisions.main(["--maps", "0"])
