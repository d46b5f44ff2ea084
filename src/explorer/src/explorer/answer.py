"""What an order is answered with."""

from typing import NamedTuple


class Answer(NamedTuple):
    """To an order. `text` says what was done, or why not."""

    done: bool
    text: str


NO_ANSWER = Answer(False, "")
