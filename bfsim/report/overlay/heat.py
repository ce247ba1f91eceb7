"""What stands beside and below a picture with heat: the cost of each row by stage, and the meaning of the colours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from PIL import Image, ImageDraw

from bfsim.report.overlay import style
from bfsim.report.wording.letters import in_letters_of_pillow
from bfsim.seen import Colour, SeenHeat
from bfsim.seen.heat import COLOURS

BARS = 150  # width of the bars beside a picture
GAP = 8
SWATCH = 14
SCALE_WIDTH, SCALE_HEIGHT = 256, 12
LINE = 28  # height of a line of words

STAGES: tuple[Colour, ...] = (
    (78, 143, 208), (224, 138, 60), (79, 168, 133), (199, 103, 168), (201, 177, 58), (123, 120, 214), (208, 96, 94),
    (90, 167, 184), (143, 143, 74),
)  # fmt: skip
"""Colours of stages in the order of the budget; they repeat when all have been used."""


def colour_of(stages: Sequence[str], stage: str) -> Colour:
    """Return the colour of one of the `stages`."""
    return STAGES[stages.index(stage) % len(STAGES)]


def longest_row_us(heats: Sequence[SeenHeat]) -> float:
    """Return the cost of the dearest row of some pictures, in µs, which is the length of the longest bar."""
    return max((float(each.total_us().sum(axis=1).max()) for each in heats), default=0.0)


def bars_of(heat: SeenHeat, height: int, longest_us: float) -> Image.Image:
    """Return a bar beside each row of a picture that is drawn `height` px high: its cost, stage by stage."""
    stages = list(heat.stages_us)
    ends_us = np.cumsum([each.sum(axis=1) for each in heat.stages_us.values()], axis=0)
    ends_px = (ends_us / (longest_us or 1.0) * BARS).round().astype(int)
    paint = np.full((ends_px.shape[1], BARS, 3), style.GRID, np.uint8)
    for stage, ends in reversed(list(zip(stages, ends_px, strict=True))):
        paint[np.arange(BARS) < ends[:, None]] = colour_of(stages, stage)
    return Image.fromarray(paint, "RGB").resize((BARS, height), Image.Resampling.NEAREST)


def heat_legend(heats: Sequence[SeenHeat], width: int, hottest_us: float, longest_us: float) -> Image.Image:
    """Return the meaning of colours and bars, and the cost of each stage on all cores, in the pictures and elsewhere."""
    stages = list(heats[0].stages_us)
    font = style.font(style.FONT)
    # the height suits all stages with any numbers, so that all frames of a run have the same legend
    height = LINE * (1 + max(line for _, line in _lines(stages, width)) + 1) + style.MARGIN // 2
    strip = Image.new("RGB", (width, height), style.PAPER)
    pen = ImageDraw.Draw(strip)
    _draw_scale(strip, pen, hottest_us, longest_us)
    told = [each for each in stages if _cost_anything(heats, each)]
    for stage, (text, faint), (x, line) in zip(told, _words(heats, told), _lines(told, width), strict=True):
        middle = LINE * (line + 1) + LINE // 2
        pen.rectangle((x, middle - SWATCH // 2, x + SWATCH, middle + SWATCH // 2), colour_of(stages, stage))
        begin = x + SWATCH + GAP
        pen.text((begin, middle), text, style.WORDS, font, anchor="lm")
        pen.text((begin + font.getlength(text), middle), faint, style.FAINT, font, anchor="lm")
    return strip


def _cost_anything(heats: Sequence[SeenHeat], stage: str) -> bool:
    return any(each.elsewhere_us[stage] or each.stages_us[stage].any() for each in heats)


def _words(heats: Sequence[SeenHeat], stages: Sequence[str]) -> Iterator[tuple[str, str]]:
    for stage in stages:
        placed = sum(float(each.stages_us[stage].sum()) for each in heats)
        elsewhere = sum(each.elsewhere_us[stage] for each in heats)
        yield f"{in_letters_of_pillow(stage)}  {placed / 1000:.2f} ms", f" + {elsewhere / 1000:.2f} elsewhere"


def _lines(stages: Sequence[str], width: int) -> list[tuple[int, int]]:
    """Return where the words on each stage begin, and on which line."""
    font = style.font(style.FONT)
    places, x, line = [], 0, 0
    for stage in stages:
        words = f"{in_letters_of_pillow(stage)}  0000.00 ms + 0000.00 elsewhere"
        step = SWATCH + GAP + round(font.getlength(words)) + 3 * GAP
        if x and x + step > width:
            x, line = 0, line + 1
        places.append((x, line))
        x += step
    return places


def _draw_scale(strip: Image.Image, pen: ImageDraw.ImageDraw, hottest_us: float, longest_us: float) -> None:
    font, middle = style.font(style.FONT), LINE // 2
    bar = Image.fromarray(COLOURS[None], "RGB").resize((SCALE_WIDTH, SCALE_HEIGHT))
    x = 0.0
    title = "time of the cores, if the whole row cost as much:  0 "
    pen.text((x, middle), title, style.FAINT, font, anchor="lm")
    x += font.getlength(title) + GAP
    strip.paste(bar, (round(x), middle - SCALE_HEIGHT // 2))
    x += SCALE_WIDTH + GAP
    ends = f"{_time(hottest_us)} a row or more      bars: what each row cost, full length {_time(longest_us)}"
    pen.text((x, middle), ends, style.FAINT, font, anchor="lm")


def _time(us: float) -> str:
    """Return a time in words, always in ms: the font has no µ."""
    return f"{us / 1000:.3g} ms"
