"""What tests of whole missions share: one mission of each topology."""

from concurrent.futures import ThreadPoolExecutor
from typing import Dict

import pytest
from team_missions import TOPOLOGIES, Mission, run_of


@pytest.fixture(scope="session")
def missions(tmp_path_factory: pytest.TempPathFactory) -> Dict[str, Mission]:
    """Side by side: each takes a third of a core, in namespaces of its own."""
    folders = [tmp_path_factory.mktemp(topology) for topology in TOPOLOGIES]
    with ThreadPoolExecutor() as pool:
        return dict(zip(TOPOLOGIES, pool.map(run_of, TOPOLOGIES, folders)))


@pytest.fixture(params=TOPOLOGIES)
def mission(missions: Dict[str, Mission], request: pytest.FixtureRequest) -> Mission:
    return missions[request.param]
