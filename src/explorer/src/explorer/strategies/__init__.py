"""The strategies by number and name. A new one is registered by importing its module here."""

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
from explorer.strategies.strategy import REGISTRY, Strategy

TITLES: Dict[int, str] = {number: REGISTRY[number].title for number in sorted(REGISTRY)}


def strategy_of(key: Union[int, str]) -> Type[Strategy]:
    """By number or name. KeyError tells what there is."""
    for strategy in REGISTRY.values():
        if key in (strategy.number, strategy.name):
            return strategy
    known = ", ".join(f"{number} {REGISTRY[number].name}" for number in sorted(REGISTRY))
    raise KeyError(f"strategy {key!r} is unknown; there are {known}")
