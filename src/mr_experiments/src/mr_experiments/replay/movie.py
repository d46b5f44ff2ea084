"""A moving picture of a recorded mission: the page of its replay in a headless Chromium, again and again, as a GIF."""

import asyncio
import io
import json
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from PIL import Image

from mr_experiments.replay.replay import page_data
from mr_measures.record.mission_record import MissionRecord
from mr_page.browser import Tab, browser
from mr_page.document import self_contained

COLOURS = 64  # the page has few, and more take more room
REST = 2000  # ms that the last picture stays
LEAST_HEIGHT = 120  # pixels, of a world that is a corridor
ONLY_THE_MAP = """
  header, aside, #tools, #timeline, #controls > :not(#clock), #source { display: none !important; }
  body, main, #scene { display: block; padding: 0; }
  #stage { position: fixed; inset: 0; height: auto; border: 0; border-radius: 0; }
  #controls { position: fixed; right: 8px; top: 6px; z-index: 1; }
  #controls { background: var(--halo); padding: 0 6px; border-radius: 4px; }
  #clock { font-size: 16px; min-width: 0; }
"""


@dataclass(frozen=True)
class Film:
    """How a movie is: pixels of width, s from begin to end, pictures in a second, light or dark."""

    width: int = 700
    seconds: float = 10.0
    rate: int = 8
    dark: bool = False

    def times(self, end: float) -> list[float]:
        """Moments of a mission of `end` s, one for each picture; first and last are its begin and end."""
        count = max(2, round(self.seconds * self.rate))
        return [end * number / (count - 1) for number in range(count)]

    def height(self, bounds: Sequence[float]) -> int:
        """Pixels in which all within left, bottom, right, top (m) fits."""
        left, bottom, right, top = bounds
        return max(LEAST_HEIGHT, round(self.width * (top - bottom) / (right - left)))


def make_movie(record: MissionRecord, film: Film) -> bytes:
    """GIF of a record with robots. Raises ReplayError for maps that cannot be read, BrowserError without a browser."""
    data = page_data(record)
    with tempfile.TemporaryDirectory(prefix="movie-") as folder:
        page = Path(folder, "replay.html")
        page.write_text(self_contained("replay", data["title"], data), encoding="utf-8")
        return moving(asyncio.run(_pictures(page, data, film)), film.rate)


async def _pictures(page: Path, data: dict[str, Any], film: Film) -> list[Image.Image]:
    end = data["end"]
    async with browser() as one:
        # A page that was asked for its end shows it as soon as it has read its maps, not before.
        address = f"{page.as_uri()}#t={end}"
        tab = await one.open(address, film.width, film.height(data["bounds"]), dark=film.dark)
        await tab.wait_for(f"Number(document.getElementById('slider').value) >= {end}")
        style = json.dumps({"textContent": ONLY_THE_MAP})
        await tab.run(f"document.head.append(Object.assign(document.createElement('style'), {style}))")
        return [await _picture(tab, time) for time in film.times(end)]


async def _picture(tab: Tab, time: float) -> Image.Image:
    """What the page shows at a time of the mission, in s."""
    await tab.run(
        "(async () => { const s = document.getElementById('slider');"
        f" s.value = {time}; s.dispatchEvent(new Event('input'));"
        " for (let i = 0; i < 2; i += 1) await new Promise(requestAnimationFrame); })()"
    )
    return Image.open(io.BytesIO(await tab.png())).convert("RGB")


def moving(pictures: Sequence[Image.Image], rate: int) -> bytes:
    """A GIF of pictures of one size, in colours that are the same in all, so that only what changes takes room."""
    palette = _palette([pictures[0], pictures[len(pictures) // 2], pictures[-1]])
    few = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    durations = [round(1000 / rate)] * (len(few) - 1) + [REST]
    out = io.BytesIO()
    few[0].save(out, "GIF", save_all=True, append_images=few[1:], duration=durations, loop=0, optimize=False)
    return out.getvalue()


def _palette(samples: Sequence[Image.Image]) -> Image.Image:
    width, height = samples[0].size
    sheet = Image.new("RGB", (width, height * len(samples)))
    for number, sample in enumerate(samples):
        sheet.paste(sample, (0, number * height))
    return sheet.quantize(COLOURS, dither=Image.Dither.NONE)
