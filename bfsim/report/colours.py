"""What firmware calls the colours of a picture: a table, JSON, and a picture beside the original."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from rich.console import RenderableType
from rich.style import Style
from rich.text import Text

from bfsim.report.jsonable import json_text
from bfsim.report.overlay import style
from bfsim.report.tables.table import new_table, percent, stacked
from bfsim.seen import NamedColour, PictureColours
from bfsim.seen.pictures import rgb_of

LEAST_SHARE = 0.005
"""Colours with a smaller share of the picture are not in the legend."""

SWATCH = 16
SCHEMA = "bfsim.colours/1"


def colours_report(found: PictureColours, patch_notes: Sequence[str]) -> RenderableType:
    """Return the table of the colours, and below it the firmware's remarks on the picture and its grey patch."""
    table = new_table("What the firmware calls the colours of the picture", "Colour", "degrees", "% of it")
    for number, each in enumerate(found.named):
        name = Text("■ ", Style(color="rgb({},{},{})".format(*each.colour))).append(each.name, "default")
        table.add_row(name, _degrees(each), percent(int((found.numbers == number).sum()), found.numbers.size))
    said = [f"Picture: {each}" for each in found.notes] + [f"Grey patch: {each}" for each in patch_notes]
    return stacked(table, *(Text(each) for each in said))


def _degrees(colour: NamedColour) -> str:
    return "{:.0f} to {:.0f}".format(*colour.hue_deg) if colour.hue_deg else ""


def colours_json(found: PictureColours, patch_notes: Sequence[str]) -> str:
    """Return the same as JSON: shares are 0 to 1."""
    colours = [
        {"name": each.name, "hue_deg": each.hue_deg, "colour": each.colour, "share": found.share(number)}
        for number, each in enumerate(found.named)
    ]
    return json_text(
        {"schema": SCHEMA, "colours": colours, "notes": found.notes, "patch_notes": list(patch_notes)}
    )


def colours_picture(uyvy: NDArray[np.uint8], found: PictureColours) -> bytes:
    """Return a PNG: the picture, beside it each pixel in the colour that the firmware names, and a legend below."""
    palette = np.array([each.colour for each in found.named], np.uint8)
    sides = rgb_of(uyvy), Image.fromarray(palette[found.numbers])
    width, height = sides[0].size
    scale = max(1, round(style.PANEL_WIDTH / width / 2))
    legend = _legend(found, 2 * width * scale + style.MARGIN)
    sheet = Image.new("RGB", (legend.width, height * scale + legend.height), style.PAPER)
    for number, each in enumerate(sides):
        large = each.resize((width * scale, height * scale), Image.Resampling.NEAREST)
        sheet.paste(large, (number * (width * scale + style.MARGIN), 0))
    sheet.paste(legend, (0, height * scale))
    file = BytesIO()
    sheet.save(file, "PNG")
    return file.getvalue()


def _legend(found: PictureColours, width: int) -> Image.Image:
    """Return a swatch, name and degrees of every colour in the picture, in as many lines as they need."""
    font = style.font(style.FONT)
    places: list[tuple[NamedColour, str, int, int]] = []
    x = y = style.MARGIN // 2
    for number, each in enumerate(found.named):
        if found.share(number) < LEAST_SHARE:
            continue
        hue = f" {_degrees(each)}°" if each.hue_deg else ""
        text = f"{each.name}{hue}, {100 * found.share(number):.1f} %"
        length = SWATCH + 6 + round(font.getlength(text)) + style.MARGIN
        if x + length > width and x > style.MARGIN:
            x, y = style.MARGIN // 2, y + style.FONT + 8
        places.append((each, text, x, y))
        x += length
    strip = Image.new("RGB", (width, y + style.FONT + style.MARGIN), style.PAPER)
    pen = ImageDraw.Draw(strip)
    for each, text, left, top in places:
        pen.rectangle((left, top, left + SWATCH, top + SWATCH), each.colour, outline=style.FAINT)
        pen.text((left + SWATCH + 6, top + SWATCH / 2), text, style.WORDS, font, anchor="lm")
    return strip
