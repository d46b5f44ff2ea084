"""What the benchmark of the page concludes from what it measured, and that it can be published."""

import json

import pytest

from mr_page.bench import rows_of

MEASURED = {"updates": 10.0, "cpu": 4.0, "kbit": 80.0}


def rows(opened=((0.3, 1.2), (0.4, 1.0)), **changes):
    return {row["what"]: row for row in rows_of(opened, {"team": {**MEASURED, **changes}}, 30.0)}


def test_rows_are_those_that_are_published():
    found = rows()
    assert all(list(row) == ["what", "bar", "value", "unit", "holds", "detail"] for row in found.values())
    assert all(row["holds"] for row in found.values())
    first = found["status page: first paint"]
    assert (first["bar"], first["value"]) == ("<= 1", 0.4) and "after 1.20 s" in first["detail"]
    assert found["status page: updates, team"]["bar"] == ">= 5"
    assert json.loads(json.dumps(found)) == found


@pytest.mark.parametrize(
    ("what", "measured"),
    [
        ("status page: updates, team", {"updates": 4.9}),
        ("status page: server, team", {"cpu": 10.1}),
        ("status page: transfer, team", {"kbit": 301.0}),
        ("status page: first paint", {"opened": ((0.3, 1.0), (1.1, 1.2))}),
    ],
)
def test_a_bar_is_missed(what, measured):
    found = rows(**measured)
    assert [name for name, row in found.items() if not row["holds"]] == [what]
