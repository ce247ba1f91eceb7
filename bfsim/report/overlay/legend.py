"""The meanings of an overlay's marks, each mark drawn by the pen that draws it in the pictures."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from PIL import Image, ImageDraw

from bfsim.report.overlay import style
from bfsim.report.overlay.pen import Pen
from bfsim.seen import SeenBlob, SeenCircle, SeenLine, SeenObject, Solid, colours
from bfsim.seen.colours import DepthScale

GLYPH = 26  # width of a mark
GAP = 28
BAR, BAR_HEIGHT = 130, 8  # of the scale of depths

BLOB = SeenBlob(
    left_px=1,
    top_px=-7,
    right_px=22,
    bottom_px=6,
    centre_px=(11.5, -0.5),
    pixels=1,
    colours=0,
    colour=style.WORDS,
)
EDGES = ((2, 3), (5, 2), (8, 2), (11, 0), (14, -1), (17, -3), (20, -3))
LINE = SeenLine(start_px=(2, 4), end_px=(22, -5), edges=1, probability=1)
CIRCLE = SeenCircle(centre_px=(12, -0.5), radius_px=8, edges=1, passed=True, tests=())
FAILED = SeenCircle(centre_px=(12, -0.5), radius_px=8, edges=1, passed=False, tests=())
OBJECT = SeenObject(
    name="", solid=Solid.BOX, colour=style.WORDS, width_mm=1, height_mm=1, accuracy=1, tests=(), place_mm=(0, 0, 1),
    is_direction=False, camera="left", image_px=(12, -0.5), image_size_px=(14, 8), age_frames=0,
)  # fmt: skip

ENTRIES: tuple[tuple[str, str, Callable[[Pen], None]], ...] = (
    ("edges", "edges", lambda pen: pen.edges(EDGES)),
    ("blobs", "blob and its centre", lambda pen: pen.blob(BLOB)),
    ("lines", "line from its start", lambda pen: pen.line(LINE, colours.LINE)),
    ("circles", "circle", lambda pen: pen.circle(CIRCLE)),
    ("circles", "circle that failed", lambda pen: pen.circle(FAILED)),
    ("objects", "object", lambda pen: pen.object(OBJECT)),
)
"""The layer of each mark, its meaning, and how it is drawn."""


OF_DEPTH = {"edges", "lines", "above"}
"""Layers whose colours show distances."""
TITLE = "3-D lines and edges by depth, mm"


def _step(text: str) -> int:
    """Return the width of an entry."""
    return GLYPH + round(style.font(style.FONT).getlength(text)) + GAP


def _scale_width() -> int:
    """Return the width of the scale of depths."""
    return round(style.font(style.FONT).getlength(TITLE)) + BAR + 3 * GAP + 100


LEGEND_WIDTH = sum(_step(text) for _, text, _ in ENTRIES) + _scale_width()
"""The width of a whole legend in one row."""


@cache
def legend(scale: DepthScale, layers: frozenset[str], width: int, *, is_empty: bool) -> Image.Image:
    """Return the legend of `layers`, in as many rows as it takes in a `width`; an empty one has the same size."""
    font = style.font(style.FONT)
    entries = [(text, draw) for layer, text, draw in ENTRIES if layer in layers]
    steps = [_step(text) for text, _ in entries]
    has_scale = bool(layers & OF_DEPTH)
    places = _places([*steps, _scale_width()] if has_scale else steps, width)
    height = (max(y for _, y in places) if places else 0) + style.FOOT // 2
    large = Image.new("RGB", (width * style.SMOOTH, height * style.SMOOTH), style.PAPER)
    if is_empty:
        return large.reduce(style.SMOOTH)
    for place, (_, draw) in zip(places, entries, strict=False):
        draw(Pen(large, style.SMOOTH, place))
    strip = large.reduce(style.SMOOTH)
    pen = ImageDraw.Draw(strip)
    for (x, y), (text, _) in zip(places, entries, strict=False):
        pen.text((x + GLYPH + 6, y), text, style.FAINT, font, anchor="lm")
    if has_scale:
        _write_scale(pen, *places[-1], scale)
    return strip


def _places(widths: list[int], room: int) -> list[tuple[int, int]]:
    """Return where entries begin, in rows of width `room`, and the middles of the rows."""
    places = []
    x, y = 0, style.FOOT // 2
    for each in widths:
        if x and x + each - GAP > room:
            x, y = 0, y + style.FOOT
        places.append((x, y))
        x += each
    return places


def _write_scale(pen: ImageDraw.ImageDraw, x: float, middle: int, scale: DepthScale) -> None:
    """Write the scale of depths: a bar of its colours between its two ends."""
    font = style.font(style.FONT)
    pen.text((x, middle), TITLE, style.FAINT, font, anchor="lm")
    x += font.getlength(TITLE) + GAP / 2
    near, far = f"{scale.near_mm:.0f}", f"{scale.far_mm:.0f}"
    pen.text((x, middle), near, style.FAINT, font, anchor="lm")
    x += font.getlength(near) + 8
    for step in range(BAR):
        depth_mm = scale.near_mm + (scale.far_mm - scale.near_mm) * step / (BAR - 1)
        ends = (x + step, middle - BAR_HEIGHT / 2), (x + step, middle + BAR_HEIGHT / 2)
        pen.line(ends, scale.colour(depth_mm))
    pen.text((x + BAR + 8, middle), far, style.FAINT, font, anchor="lm")
