"""A node without its ROS master: one that is not there yet, hangs, or has gone."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
from pathlib import Path
from typing import Any, Iterator

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

from namespaces import die_with_parent, program, wait_until

PATIENCE = 30.0  # s


def free_port() -> int:
    with socket.socket() as listener:
        listener.bind(("localhost", 0))
        return int(listener.getsockname()[1])


class Computer:
    """Of one robot: what runs on it has the same master."""

    def __init__(self, name: str, home: Path) -> None:
        self.name, self.home, self.port = name, home, free_port()
        self.environment = {**os.environ, "ROS_MASTER_URI": f"http://localhost:{self.port}", "ROS_HOME": str(home)}
        self.processes: list[subprocess.Popen[str]] = []

    def start(self, *command: str, output: Any = subprocess.DEVNULL) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            command,
            env=self.environment,
            stdout=output,
            stderr=subprocess.DEVNULL,
            text=True,
            preexec_fn=die_with_parent,
        )
        self.processes.append(process)
        return process

    def start_master(self) -> subprocess.Popen[str]:
        master = self.start("rosmaster", "--core", "-p", str(self.port))
        address = ("localhost", self.port)
        with socket.socket() as connection:
            wait_until(lambda: connection.connect_ex(address) == 0, PATIENCE, "the master is there")
        return master

    def start_node(self, *arguments: str) -> subprocess.Popen[str]:
        return self.start(
            program("adhoc_communication"), f"_robot_name:={self.name}", f"_interface:=hub:{self.home}/hub", *arguments
        )

    def call(self, service: str, *arguments: str) -> str:
        command = ["rosservice", "call", f"/adhoc_communication/{service}", *arguments]
        done = subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=PATIENCE)
        return done.stdout + done.stderr

    def say(self, topic: str, text: str) -> None:
        wait_until(lambda: "status: 1" in self.call("send_string", "bob", topic, text), PATIENCE, f"{text} is sent")

    def switch_off(self) -> None:
        for process in self.processes:
            process.kill()
            process.wait()


@pytest.fixture
def alice(tmp_path: Path) -> Iterator[Computer]:
    computer = Computer("alice", tmp_path)
    yield computer
    computer.switch_off()


@pytest.fixture
def bob(tmp_path: Path) -> Iterator[Computer]:
    computer = Computer("bob", tmp_path)
    yield computer
    computer.switch_off()


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_a_node_that_waits_for_its_master_can_be_ended(bob: Computer, how: signal.Signals) -> None:
    with socket.create_server(("localhost", bob.port)) as silent:
        silent.settimeout(PATIENCE)
        node = bob.start(program("adhoc_communication"))  # without parameters, which would go to the master before
        silent.accept()[0].close()  # it asks for its master
        node.send_signal(how)
        assert node.wait(5.0) == -how


def test_known_topics_go_on_and_the_node_ends_in_order_when_its_master_has_gone(alice: Computer, bob: Computer) -> None:
    alice.start(program("radio"), "--hub", str(alice.home / "hub"))
    alice.start_master()
    alice.start_node()
    master = bob.start_master()
    node = bob.start_node("_inject_allow:=* /new")
    heard = bob.home / "heard"
    with heard.open("w") as file:
        bob.start("rostopic", "echo", "/greeting/data", output=file)
    alice.say("greeting", "one")
    # Latched, so the listener may come late.
    wait_until(lambda: "one" in heard.read_text(), PATIENCE, "one is heard")
    master.send_signal(signal.SIGSTOP)
    # The thread that publishes asked the master itself: it stood still until that answered.
    alice.say("new", "which the node is to advertise")
    alice.say("greeting", "two")
    wait_until(lambda: "two" in heard.read_text(), PATIENCE, "two is heard")
    master.kill()
    alice.say("newer", "of which nothing is known")
    alice.say("greeting", "three")
    wait_until(lambda: "three" in heard.read_text(), PATIENCE, "three is heard")
    node.send_signal(signal.SIGTERM)
    assert node.wait(10.0) == 0
