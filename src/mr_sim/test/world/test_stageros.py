"""stageros without a master: how it ends when a robot cannot be had."""

import threading

import pytest

from mr_sim import stageros
from mr_sim.stageros_options import Prefixes
from mr_sim.world_client import ConnectionRefused


def test_a_robot_that_the_world_refuses_ends_the_world(make_world, tmp_path, monkeypatch):
    def refuse(path, name, timeout):
        raise ConnectionRefused(f"the world on {path} refuses {name}: too many connections")

    monkeypatch.setattr(stageros.WorldClient, "connect", refuse)
    world, before = make_world('rover ( name "a" )\n'), threading.active_count()
    with pytest.raises(ConnectionRefused, match="refuses a: too many"):
        stageros._run(world, [Prefixes("", "")], 1.0, str(tmp_path))
    assert threading.active_count() == before and not (tmp_path / "world").exists()
