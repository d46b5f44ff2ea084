"""Commands that start nothing: launch files are read with the arguments of the pages, targets of the Makefile to their
last command, programs that are only named say what they do. Part of `make test`."""

import shutil
from typing import Dict

import pytest
from lines import ALL, CHEAP, RUN
from pages import REPOSITORY
from running import Line, Ran, fault, in_a_shell, sandbox
from table import NOT_RUN, SHORTENED

KEY = Line("", 0, "", "rosrun adhoc_communication team_key create $HOME/team.key")


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Dict[Line, Ran]:
    """With what the pages have made before: a robot of one's own and a key."""
    folder = sandbox(tmp_path_factory.mktemp("cheap"))
    shutil.copy(REPOSITORY / "docs/examples/my_robot.yaml", folder)
    return in_a_shell([KEY, *CHEAP], folder)


@pytest.mark.parametrize("line", CHEAP, ids=lambda line: line.name)
def test_it_runs(ran: Dict[Line, Ran], line: Line) -> None:
    assert not fault(line, ran[line])


def test_every_row_of_the_table_is_for_a_command() -> None:
    unused = [words.pattern for words in NOT_RUN if not any(words.match(line.text) for line in ALL)]
    steps = {words.pattern for words in SHORTENED}
    for line in RUN:
        text = line.text
        for words, instead in SHORTENED.items():
            if words.search(text):
                steps.discard(words.pattern)
            text = words.sub(instead, text)
    assert not unused and not steps, (unused, steps)
