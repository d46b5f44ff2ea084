"""How the figures of a report look, and how they are written."""

from __future__ import annotations

import html
import io
import re
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # no display needed

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

# Okabe and Ito's palette, told apart by people of any colour vision; the dash tells the curves apart in grey, too.
TEAM_COLOURS = {1: "#0072B2", 2: "#E69F00", 3: "#009E73", 4: "#CC79A7", 8: "#D55E00", 16: "#56B4E9"}
TEAM_DASHES = {1: "-", 2: (0, (6, 1.5)), 3: (0, (3, 1)), 4: (0, (6, 1.5, 1.5, 1.5)), 8: (0, (1.5, 1)), 16: "-"}
OTHER_COLOUR, OTHER_DASH = "#7F7F7F", "-"
INK = "#1b1f23"  # text and axes; follows the page's colour in SVG
PNG_RESOLUTION = 150  # dots per inch

STYLE = {
    "font.family": "sans-serif",
    "font.size": 10.5,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.titlesize": 10.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.facecolor": "none",
    "figure.facecolor": "none",
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "grid.color": "#8a8f98",
    "grid.alpha": 0.25,
    "axes.grid": True,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "lines.linewidth": 1.9,
    "svg.fonttype": "none",
    "figure.constrained_layout.use": True,
}


def team_colour(robots: int) -> str:
    return TEAM_COLOURS.get(robots, OTHER_COLOUR)


def team_dash(robots: int) -> object:
    return TEAM_DASHES.get(robots, OTHER_DASH)


def write_png(figure: Figure, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=PNG_RESOLUTION, facecolor="white")


def to_svg(figure: Figure, name: str, description: str) -> str:
    """An `<svg>` element for a page: its text takes the colour of the page, its ids begin with `name`."""
    out = io.StringIO()
    with plt.rc_context({**STYLE, "svg.hashsalt": name}):
        figure.savefig(out, format="svg", transparent=True, metadata={"Date": None})
    text = out.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r"(\d\.\d\d)\d+", r"\1", text)  # hundredths of a point are fine enough
    text = re.sub(r'\bid="', f'id="{name}-', text)
    text = re.sub(r'href="#', f'href="#{name}-', text)
    text = text.replace("url(#", f"url(#{name}-").replace(INK, "currentColor")
    text = re.sub(r'(<svg\b[^>]*?) width="[^"]*"', r"\1", text, count=1)
    text = re.sub(r'(<svg\b[^>]*?) height="[^"]*"', r"\1", text, count=1)
    return text.replace("<svg", f'<svg role="img" aria-label="{html.escape(description)}"', 1)
