"""What a team needs of the computer, found before anything starts."""

import socket

import pytest

from mr_launch import programs
from mr_launch.errors import UserError


@pytest.fixture
def client_ports(tmp_path, monkeypatch):
    path = tmp_path / "ip_local_port_range"
    monkeypatch.setattr(programs, "CLIENT_PORTS", path)
    return path


def test_no_port_of_clients_is_meant_for_a_master(client_ports):
    """A node that connected to anything once took the port of a master that had not begun to listen."""
    client_ports.write_text("12050\t60999\n")
    ports = programs.free_ports(8)
    assert len(set(ports)) == 8 and all(12000 <= port < 12050 for port in ports)


def test_a_port_in_use_is_passed_over(client_ports, monkeypatch):
    (port,) = programs.free_ports(1)
    monkeypatch.setattr(programs, "LEAST_PORT", port)
    client_ports.write_text(f"{port + 1} 60999")
    assert programs.free_ports(1) == [port]
    with socket.socket() as used:
        used.bind(("localhost", port))
        with pytest.raises(UserError, match=f"fewer than 1 of the TCP ports from {port} to {port} are free"):
            programs.free_ports(1)


@pytest.mark.parametrize("told", ["1024 65535", "", None])
def test_where_nearly_all_ports_are_for_clients_or_nobody_tells(client_ports, told):
    if told is not None:
        client_ports.write_text(told)
    (port,) = programs.free_ports(1)
    assert 12000 <= port < 65536
