"""Every command of the pages that takes long is run, as the table shortens it, or the table says why not.

One mission of three robots is there for all that look into a running one. It is ended by Ctrl-C, and then looked at
again by those that want its results.
"""

import signal
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Dict, List

import pytest
from lines import LONG
from running import PATIENCE_S, Line, Ran, environment, fault, in_a_shell, sandbox
from table import Where, where

from mr_launch.programs import free_ports

PAGES = list(dict.fromkeys(line.page for line in LONG))
READY_S = 120.0
# A robot that no page steers waits, so that the mission is not over before the commands are through on a busy computer.
HOLD = Line("", 0, "", "rosrun mr_launch enter robot_1 rosservice call /explorer/pause")


def lines(place: Where, page: str = "") -> List[Line]:
    return [line for line in LONG if where(line.words) == place and page in ("", line.page)]


@pytest.fixture(scope="module")
def ran(tmp_path_factory: pytest.TempPathFactory) -> Dict[Line, Ran]:
    """All at once: what needs no mission while the mission goes on, each page in a folder of its own."""
    folder = sandbox(tmp_path_factory.mktemp("mission"))
    with ThreadPoolExecutor(3) as pool:
        mission = pool.submit(with_mission, folder)
        alone = [
            pool.submit(in_a_shell, lines(Where.ALONE, page), sandbox(tmp_path_factory.mktemp(Path(page).stem)))
            for page in PAGES
        ]
        found = mission.result()
        for each in alone:
            found.update(each.result())
    return found


def with_mission(folder: Path) -> Dict[Line, Ran]:
    (first,) = lines(Where.MISSION)
    log = folder / "mission.log"
    (port,) = free_ports(1)
    command = f"source tools/environment.sh; exec {first.words.format(port=port)}"
    with log.open("wb") as output:
        process = subprocess.Popen(
            ["bash", "-c", command], cwd=folder, env=environment(folder), stdin=subprocess.DEVNULL, stdout=output,
            stderr=subprocess.STDOUT, start_new_session=True,
        )  # fmt: skip
    try:
        until_they_explore(process, log)
        assert in_a_shell([HOLD], folder)[HOLD].code == 0
        with ThreadPoolExecutor(3) as pool:
            several = pool.map(lambda page: in_a_shell(lines(Where.DURING, page), folder), PAGES)
            found = {line: each for of_page in several for line, each in of_page.items()}
        assert process.poll() is None, f"the mission was over before:\n{log.read_text()[-2000:]}"
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(PATIENCE_S)
    found[first] = Ran(process.returncode, log.read_text())
    for page in PAGES:
        found.update(in_a_shell(lines(Where.AFTER, page), folder))
    return found


def until_they_explore(process: "subprocess.Popen[bytes]", log: Path) -> None:
    end = time.monotonic() + READY_S
    while "\nexploring" not in log.read_text(errors="replace"):
        assert process.poll() is None and time.monotonic() < end, log.read_text()[-3000:]
        time.sleep(0.1)


@pytest.mark.parametrize(
    "line", [line for line in LONG if where(line.words) != Where.MISSION], ids=lambda line: line.name
)
def test_it_runs(ran: Dict[Line, Ran], line: Line) -> None:
    assert not fault(line, ran[line])


def test_ctrl_c_ends_the_mission_in_order_and_it_has_written_its_results(ran: Dict[Line, Ran]) -> None:
    (line,) = lines(Where.MISSION)
    code, output = ran[line]
    assert code == 130, output[-3000:]
    assert "status page at http://localhost:" in output
