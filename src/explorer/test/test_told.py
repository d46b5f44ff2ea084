"""Places that others have explored: what is believed at each time, however it has come to be asked for."""

import random
from typing import List, Tuple

import numpy as np

from explorer.told import MAXIMUM_TOLD, ToldPlaces


def believed(told: ToldPlaces, now: float) -> List[Tuple[float, float, str]]:
    places, robots = told.at(now)
    assert places.shape == (len(robots), 2) and places.dtype == float and places.flags.c_contiguous
    return [(x, y, robot) for (x, y), robot in zip(places.tolist(), robots)]


def test_places_are_believed_until_their_time() -> None:
    told = ToldPlaces()
    assert believed(told, 0.0) == [] and not told.expired(0.0)
    told.add(1.0, 2.0, 8.0, "robot_1")
    told.add(3.0, 4.0, 9.0, "robot_2")
    assert believed(told, 7.9) == [(1.0, 2.0, "robot_1"), (3.0, 4.0, "robot_2")]
    assert told.expired(8.0) and believed(told, 8.0) == [(3.0, 4.0, "robot_2")] and not told.expired(8.0)
    assert believed(told, 9.0) == []


def test_any_order_of_telling_asking_and_ending_gives_what_a_list_would() -> None:
    for seed in range(20):
        chance, told, expected, now = random.Random(seed), ToldPlaces(), [], 0.0
        for _ in range(300):
            now += chance.choice((0.0, 0.5, -0.2))
            for _ in range(chance.randrange(4)):
                each = (chance.random(), chance.random(), now + 8.0, f"robot_{chance.randrange(3)}")
                told.add(*each)
                expected.append(each)
            if chance.random() < 0.5:
                # While the first is believed nobody looks at the others, which a clock that was set back disorders.
                if expected and expected[0][2] <= now:
                    expected = [each for each in expected if each[2] > now]
                assert believed(told, now) == [(x, y, robot) for x, y, _, robot in expected]


def test_the_newest_are_kept() -> None:
    told = ToldPlaces()
    for number in range(MAXIMUM_TOLD + 5):
        told.add(float(number), 0.0, 8.0, "robot_1")
        if number == MAXIMUM_TOLD // 2:
            told.at(0.0)
    places, robots = told.at(0.0)
    assert np.array_equal(places[:, 0], np.arange(5.0, MAXIMUM_TOLD + 5.0)) and len(robots) == MAXIMUM_TOLD
