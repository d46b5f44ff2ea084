"""Options of this package's programs."""

import argparse
from typing import NoReturn

from mr_launch.errors import UserError


class OptionParser(argparse.ArgumentParser):
    """Bad options become a UserError of one line instead of the whole usage."""

    def error(self, message: str) -> NoReturn:
        raise UserError(f"{message} (--help lists the options)")
