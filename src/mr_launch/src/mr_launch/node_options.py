"""What the nodes themselves would refuse of their parameters, without starting them."""

from __future__ import annotations

import socket
from typing import Any, Callable, Mapping

from explorer import options as explorer_options
from explorer.errors import ExplorerError
from map_merger import options as merger_options

Parameters = Mapping[str, Any]


def explorer_fault(given: Parameters) -> str:
    """Why explorer would not start with these; empty if it would."""
    try:
        explorer_options.load(given)
    except ExplorerError as error:
        return str(error)
    return ""


def merger_fault(given: Parameters) -> str:
    """Why map_merger would not start with these, of which it knows not all; empty if it would."""
    values = {name: value for name, value in given.items() if name in merger_options.PARAMETERS}
    if values.get("initial_poses") == "":
        del values["initial_poses"]
    try:
        merger_options.options_of(values, socket.gethostname())
    except merger_options.OptionError as error:
        return str(error)
    return ""


KINDS: dict[str, dict[str, type]] = {
    "explorer": {parameter.name: parameter.type for parameter in explorer_options.PARAMETERS},
    "map_merger": {name: parameter.kind for name, parameter in merger_options.PARAMETERS.items()},
}
"""Of parameters, by node and name."""
FAULTS: dict[str, Callable[[Parameters], str]] = {"explorer": explorer_fault, "map_merger": merger_fault}
"""By node."""
