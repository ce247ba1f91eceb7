"""Write the drawing of a memory map as a file: PNG by pillow, or SVG."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from io import BytesIO
from pathlib import Path
from xml.sax.saxutils import escape

from PIL import Image, ImageDraw, ImageFont

from bfsim.errors import ConfigError, legible
from bfsim.report.ldf.drawing import drawing_of
from bfsim.report.ldf.map import MemoryMap
from bfsim.report.ldf.sheet import PAPER, FilledBox, Sheet, Words
from bfsim.report.wording.letters import in_letters_of_pillow

PIXELS = 2
"""PNG pixels per px of the drawing, so that small letters stay readable."""


def picture_bytes(memory_map: MemoryMap, path: Path) -> bytes:
    """Return the picture of a map in the format of `path`'s suffix.

    Raises ConfigError for suffixes other than .png and .svg.
    """
    return format_of(path)(drawing_of(memory_map))


def format_of(path: Path) -> Callable[[Sheet], bytes]:
    """Return the function that makes such a file from a drawing; raise ConfigError if there is none."""
    try:
        return FORMATS[path.suffix.lower()]
    except KeyError:
        raise ConfigError(f"--picture must be a file *{' or *'.join(FORMATS)}, not {path}") from None


def png_of(sheet: Sheet) -> bytes:
    """Return a drawing as a PNG file."""
    image = Image.new("RGB", (round(sheet.width * PIXELS), round(sheet.height * PIXELS)), PAPER)
    pen = ImageDraw.Draw(image)
    for box in sheet.boxes:
        left, top = round(box.x * PIXELS), round(box.y * PIXELS)
        # pillow includes the corner; a piece that is too small to see becomes a line of one pixel
        right = max(left, round((box.x + box.width) * PIXELS) - 1)
        bottom = max(top, round((box.y + box.height) * PIXELS) - 1)
        pen.rectangle((left, top, right, bottom), fill=box.fill or None, outline=box.outline or None)
    for words in sheet.words:
        font = ImageFont.load_default(words.font_px * PIXELS)
        place = (words.x * PIXELS, words.y * PIXELS)
        text = in_letters_of_pillow(words.text)
        pen.text(place, text, fill=words.colour, font=font, anchor="rm" if words.is_right else "lm")
    file = BytesIO()
    image.save(file, "PNG")
    return file.getvalue()


def svg_of(sheet: Sheet) -> bytes:
    """Return a drawing as an SVG file."""
    view = f"{sheet.width:g} {sheet.height:g}"
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {view}" font-family="sans-serif">',
        f'<rect width="100%" height="100%" fill="{PAPER}"/>',
        *_svg_lines(sheet),
        "</svg>",
    ]
    return legible("\n".join(lines) + "\n").encode()


def _svg_lines(sheet: Sheet) -> Iterator[str]:
    yield from (_svg_box(each) for each in sheet.boxes)
    yield from (_svg_words(each) for each in sheet.words)


def _svg_box(box: FilledBox) -> str:
    outline = f' stroke="{box.outline}"' if box.outline else ""
    return (
        f'<rect x="{box.x:.2f}" y="{box.y:.2f}" width="{box.width:.2f}" height="{box.height:.2f}" '
        f'fill="{box.fill or "none"}"{outline}/>'
    )


def _svg_words(words: Words) -> str:
    anchor = ' text-anchor="end"' if words.is_right else ""
    return (
        f'<text x="{words.x:.2f}" y="{words.y:.2f}" font-size="{words.font_px}" fill="{words.colour}" '
        f'dominant-baseline="central"{anchor}>{escape(words.text)}</text>'
    )


FORMATS: dict[str, Callable[[Sheet], bytes]] = {".png": png_of, ".svg": svg_of}
