"""What tests of whole missions share: one mission of each topology."""

from typing import Dict

import pytest
from team_missions import TOPOLOGIES, Mission, run_of


@pytest.fixture(scope="session")
def missions(tmp_path_factory: pytest.TempPathFactory) -> Dict[str, Mission]:
    return {topology: run_of(topology, tmp_path_factory.mktemp(topology)) for topology in TOPOLOGIES}


@pytest.fixture(params=TOPOLOGIES)
def mission(missions: Dict[str, Mission], request: pytest.FixtureRequest) -> Mission:
    return missions[request.param]
