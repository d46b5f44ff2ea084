"""The strategies by number and name. A new one is registered by importing its module here, or from outside by its place
(`outside.strategy_at`): as the parameter `strategy`, or in the environment variable EXPLORER_STRATEGIES."""

from typing import Dict, Type, Union

from explorer.strategies import (  # noqa: F401
    coordinated,
    furthest,
    nearest,
    nearest_path,
    negotiated,
    paper_auction,
    random_frontier,
)
from explorer.strategies.outside import VARIABLE, strategies_of_environment, strategy_at
from explorer.strategies.strategy import REGISTRY, Strategy
from mr_grid.by_place import names_a_place

BUILT_IN = tuple(sorted(REGISTRY))
strategies_of_environment()
TITLES: Dict[int, str] = {number: REGISTRY[number].title for number in sorted(REGISTRY)}


def strategy_of(key: Union[int, str]) -> Type[Strategy]:
    """By number, name or place. KeyError tells what there is, or what is wrong at that place."""
    if isinstance(key, str) and names_a_place(key):
        return strategy_at(key)
    for strategy in REGISTRY.values():
        if key in (strategy.number, strategy.name):
            return strategy
    known = ", ".join(f"{number} {REGISTRY[number].name}" for number in sorted(REGISTRY))
    raise KeyError(f"strategy {key!r} is unknown; there are {known}, and those that {VARIABLE}=FILE.py:Class names")


def number_of(text: str) -> int:
    """Of a strategy by number or name, as programs take it that hand the number on. KeyError as above."""
    if names_a_place(text):
        raise KeyError(f"strategy {text!r}: set {VARIABLE}={text}, then give its number or name")
    return strategy_of(int(text) if text.lstrip("-").isdigit() else text).number
