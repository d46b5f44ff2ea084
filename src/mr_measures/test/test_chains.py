"""Chains of places that a team visits, and how large the disc in a footprint is."""

import itertools

import numpy as np
import pytest

from mr_measures.lower_bound import shared_out, shortest_chains
from mr_measures.visibility import inscribed_radius


def test_inscribed_radius():
    assert inscribed_radius([((-0.2, -0.1), (0.3, -0.1), (0.3, 0.15), (-0.2, 0.15))]) == pytest.approx(0.1)
    assert inscribed_radius([((1.0, 1.0), (2.0, 1.0), (2.0, 2.0))]) == 0.0


def chain_length(order, entry, between):
    return entry[order[0]] + sum(between[a, b] for a, b in itertools.pairwise(order)) if order else 0.0


def test_shortest_chains_against_every_order():
    generator = np.random.default_rng(2)
    entry, between = generator.uniform(0.0, 5.0, 4), generator.uniform(0.0, 5.0, (4, 4))
    lengths = shortest_chains(entry, between)
    for chosen in range(16):
        places = [place for place in range(4) if chosen >> place & 1]
        expected = min(chain_length(order, entry, between) for order in itertools.permutations(places))
        assert lengths[chosen] == pytest.approx(expected)


def test_shared_out_against_every_partition():
    generator = np.random.default_rng(3)
    first, second = np.sort(generator.uniform(0.0, 5.0, (2, 8)), axis=1)
    best = shared_out(first, second)
    for chosen in range(8):
        parts = [part for part in range(8) if part & chosen == part]
        assert best[chosen] == min(max(first[chosen ^ part], second[part]) for part in parts)
