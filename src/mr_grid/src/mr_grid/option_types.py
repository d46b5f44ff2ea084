"""Types of options on command lines. A text that does not fit becomes argparse.ArgumentTypeError, which says what is
needed."""

import argparse
import math


def finite(text: str) -> float:
    """A number that is one."""
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise argparse.ArgumentTypeError(f"a finite number is needed, not {text!r}")
    return number


def positive(text: str) -> float:
    """A number above 0."""
    number = finite(text)
    if number <= 0.0:
        raise argparse.ArgumentTypeError(f"a number above 0 is needed, not {text!r}")
    return number


def picture(text: str) -> str:
    """The name of a file that matplotlib can write."""
    if not text.endswith((".png", ".pdf", ".svg")):
        raise argparse.ArgumentTypeError(f"a name that ends in .png, .pdf or .svg is needed, not {text!r}")
    return text
