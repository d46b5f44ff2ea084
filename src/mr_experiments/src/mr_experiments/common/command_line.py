"""What the commands of this package have in common."""

from __future__ import annotations

import argparse
from typing import NoReturn

BAD_CALL, INTERRUPTED = 2, 130  # exit codes


class CallError(ValueError):
    """Options that cannot be used; the text names the option."""


class Parser(argparse.ArgumentParser):
    """Bad options become one line instead of the whole usage."""

    def error(self, message: str) -> NoReturn:
        raise CallError(f"{message} (--help lists the options)")
