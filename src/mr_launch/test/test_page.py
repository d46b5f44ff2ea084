"""The status page of a team is on the computer's own network while the team has one of its own, and goes with it."""

import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest

from mr_launch.arguments import parse_arguments
from mr_launch.commands import page_listener
from mr_launch.errors import UserError

HERE = Path(__file__).resolve().parent
PATIENCE = 30.0  # s


@pytest.fixture
def port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def page(port):
    """Text of the page, empty while there is none."""
    try:
        with urllib.request.urlopen(f"http://localhost:{port}/", timeout=2.0) as answer:
            return answer.read().decode()
    except OSError:
        return ""


@pytest.mark.parametrize("isolation", ["namespaces", "hub"])
def test_the_page_is_there_and_goes_with_the_team(tmp_path, port, isolation):
    environment = {**os.environ, "DUMMY_ENDLESS": "1", "DUMMY_PAGE": str(port)}
    kind = "user namespaces" if isolation == "namespaces" and os.geteuid() else isolation
    command = [sys.executable, str(HERE / "dummy_team.py"), str(tmp_path / "out"), kind]
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL)
    try:
        end = time.monotonic() + PATIENCE
        while not (text := page(port)):
            assert time.monotonic() < end and process.poll() is None
            time.sleep(0.05)
    finally:
        process.send_signal(signal.SIGINT)
        code = process.wait(PATIENCE)
    assert "office26x15, 2 robots" in text and code == 130
    assert not page(port)


def test_a_port_that_others_have_is_named(port):
    with socket.socket() as other:
        other.bind(("127.0.0.1", port))
        other.listen()
        with pytest.raises(UserError, match=f"port {port}: .* give another port with --page"):
            page_listener(port)


@pytest.mark.parametrize(("words", "port"), [([], 0), (["--page"], 8088), (["--page", "9000"], 9000)])
def test_the_option(words, port):
    assert parse_arguments(words).page == port
