"""What the marks of an overlay mean, each drawn by the pen that draws it in the pictures."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

from PIL import Image, ImageDraw

from bfsim.report.overlay import style
from bfsim.report.overlay.panel import Pen
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

ENTRIES: tuple[tuple[str, Callable[[Pen], None]], ...] = (
    ("edges", lambda pen: pen.edges(EDGES)),
    ("blob and its centre", lambda pen: pen.blob(BLOB)),
    ("line from its start", lambda pen: pen.line(LINE, colours.LINE)),
    ("circle", lambda pen: pen.circle(CIRCLE)),
    ("circle that failed", lambda pen: pen.circle(FAILED)),
    ("object", lambda pen: pen.object(OBJECT)),
)


TITLE = "3-D lines and edges by depth, mm"


def _steps() -> list[int]:
    """Return how wide each entry is."""
    font = style.font(style.FONT)
    return [GLYPH + round(font.getlength(text)) + GAP for text, _ in ENTRIES]


LEGEND_WIDTH = sum(_steps()) + round(style.font(style.FONT).getlength(TITLE)) + BAR + 3 * GAP + 100


@cache
def legend(scale: DepthScale) -> Image.Image:
    """Return the legend as a strip."""
    font = style.font(style.FONT)
    middle = style.FOOT // 2
    steps = _steps()
    large = Image.new("RGB", (LEGEND_WIDTH * style.SMOOTH, style.FOOT * style.SMOOTH), style.PAPER)
    x = 0
    for (_, draw), step in zip(ENTRIES, steps, strict=True):
        draw(Pen(large, style.SMOOTH, (x, middle)))
        x += step
    strip = large.reduce(style.SMOOTH)
    pen = ImageDraw.Draw(strip)
    x = 0
    for (text, _), step in zip(ENTRIES, steps, strict=True):
        pen.text((x + GLYPH + 6, middle), text, style.FAINT, font, anchor="lm")
        x += step
    _write_scale(pen, x, middle, scale)
    return strip


def _write_scale(pen: ImageDraw.ImageDraw, x: float, middle: int, scale: DepthScale) -> None:
    """Write the scale of depths: its ends at either side of a bar of its colours."""
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
