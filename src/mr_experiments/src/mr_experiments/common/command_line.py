"""What the commands of this package have in common."""

from __future__ import annotations

import argparse
from typing import NoReturn

from explorer.strategies import number_of

BAD_CALL, INTERRUPTED = 2, 130  # exit codes


class CallError(ValueError):
    """Options that cannot be used; the text names the option."""


def strategy_number(text: str) -> int:
    """Of a strategy by number or name, as an option's type."""
    try:
        return number_of(text)
    except KeyError as error:
        raise argparse.ArgumentTypeError(error.args[0]) from None


class Parser(argparse.ArgumentParser):
    """Bad options become one line instead of the whole usage."""

    def error(self, message: str) -> NoReturn:
        raise CallError(f"{message} (--help lists the options)")
