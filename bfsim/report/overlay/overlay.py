"""What was seen in a frame, drawn over its pictures: the cameras side by side on a dark sheet, with a legend."""

from __future__ import annotations

from collections.abc import Collection

from PIL import Image, ImageDraw

from bfsim.report.overlay import style
from bfsim.report.overlay.above import above_of
from bfsim.report.overlay.heat import BARS, GAP, bars_of, heat_legend, longest_row_us
from bfsim.report.overlay.labels import Label, write_labels
from bfsim.report.overlay.layers import ABOVE, LAYERS, only
from bfsim.report.overlay.legend import LEGEND_WIDTH, legend
from bfsim.report.overlay.panel import panel_of
from bfsim.seen import Seen, SeenFrame
from bfsim.seen.colours import DepthScale, depths_of
from bfsim.seen.heat import hottest_row_us

BETWEEN = "   "
"""Separates two numbers."""

HIGHEST = 2
"""The greatest height of a magnified picture, as a multiple of the wanted width: a few columns would fill gigapixels."""


def overlay_of(
    frame: SeenFrame, layers: Collection[str] = LAYERS, panel_width: int = style.PANEL_WIDTH
) -> Image.Image:
    """Return the sheet of a frame, RGB, with some `layers` drawn; pictures of one size have sheets of one size.

    A picture is about `panel_width` pixels wide, but at most twice as high; a single picture is about as wide as the
    legend in one row. Cameras that see depth have a view from above beside them, and pictures with heat the cost of
    each row.
    """
    frame, scale = only(frame, layers), depths_of(frame)
    wanted_px = panel_width if len(frame.cameras) > 1 else LEGEND_WIDTH
    heats = [each.heat for each in frame.cameras if each.heat]
    hottest_us, longest_us = hottest_row_us(heats), longest_row_us(heats)
    panels = [_panel(frame, each, wanted_px, scale, hottest_us) for each in frame.cameras]
    highest = max(image.height for image, _ in panels)
    above = above_of(frame, scale, highest) if ABOVE in layers and _sees_depth(frame) else None
    highest = max(highest, above.height if above else 0)
    inside = sum(image.width for image, _ in panels) + style.MARGIN * (len(panels) - 1)
    inside += above.width + style.MARGIN if above else 0
    inside += (BARS + GAP) * len(heats)
    # for slim pictures, the sheet is wide enough for words
    room = inside if inside >= style.PANEL_WIDTH else LEGEND_WIDTH
    has_marks = any(map(_has_marks, frame.cameras))
    marks = legend(scale, frozenset(layers), room, is_empty=not has_marks)
    below = heat_legend(heats, room, hottest_us, longest_us) if heats else None
    height = style.HEAD + highest + marks.height + (below.height if below else 0)
    sheet = Image.new("RGB", (room + 2 * style.MARGIN, height), style.PAPER)
    pen = ImageDraw.Draw(sheet)
    left = style.MARGIN
    for seen, (image, labels) in zip(frame.cameras, panels, strict=True):
        sheet.paste(image, (left, style.HEAD))
        _write_head(pen, frame, seen, left, image.width)
        write_labels(pen, labels, (left, style.HEAD, left + image.width, style.HEAD + image.height))
        left += image.width
        if seen.heat:
            sheet.paste(bars_of(seen.heat, image.height, longest_us), (left + GAP, style.HEAD))
            left += GAP + BARS
        left += style.MARGIN
    if above:
        sheet.paste(above, (left, style.HEAD))
        pen.text((left, style.HEAD // 2), "from above, mm", style.WORDS, style.font(style.FONT), anchor="lm")
    sheet.paste(marks, (style.MARGIN, style.HEAD + highest))
    if below:
        sheet.paste(below, (style.MARGIN, height - below.height))
    return sheet


def _has_marks(seen: Seen) -> bool:
    """Whether the legend has anything to explain: without a view, firmware has no marks."""
    features = (seen.edges, seen.blobs, seen.lines, seen.circles, seen.objects, seen.lines_3d, seen.edges_3d)
    return any(len(each) for each in features)


def _sees_depth(frame: SeenFrame) -> bool:
    """Whether places in space can be known: the same for all frames of a recording."""
    return any(each.baseline_mm for each in frame.geometries.values()) and len(frame.cameras) > 1


def _panel(
    frame: SeenFrame, seen: Seen, wanted_px: int, depths: DepthScale, hottest_us: float
) -> tuple[Image.Image, list[Label]]:
    scale = max(1, min(round(wanted_px / seen.width_px), HIGHEST * wanted_px // seen.height_px))
    objects = tuple(each for each in frame.objects if each.camera == seen.camera)
    if seen.camera != "left":
        return panel_of(seen, objects, (), (), scale, depths, hottest_us)
    return panel_of(seen, objects, frame.lines_3d, tuple(frame.edges_3d()), scale, depths, hottest_us)


def _write_head(pen: ImageDraw.ImageDraw, frame: SeenFrame, seen: Seen, left: int, width: int) -> None:
    """Write whose picture it is, when it was taken, and what was seen, the last numbers only if there is room."""
    font, middle = style.font(style.FONT), style.HEAD // 2
    title = f"{seen.camera} camera"
    pen.text((left, middle), title, style.WORDS, font, anchor="lm")
    when = f"frame {frame.index}   {frame.times_ns[seen.camera] / 1e9:.3f} s"
    begin = left + font.getlength(title) + style.MARGIN
    pen.text((begin, middle), when, style.FAINT, font, anchor="lm")
    counts = _counts(seen)
    room = left + width - begin - font.getlength(when) - style.MARGIN
    while counts and font.getlength(BETWEEN.join(counts)) > room:
        counts.pop()
    pen.text((left + width, middle), BETWEEN.join(counts), style.FAINT, font, anchor="rm")


def _counts(seen: Seen) -> list[str]:
    """Return how many of each kind were seen, edges first."""
    lost = f", {seen.edges.lost} without room" if seen.edges.lost else ""
    others = (
        (len(seen.blobs), "blob"),
        (len(seen.lines), "line"),
        (sum(each.passed for each in seen.circles), "circle"),
    )
    edges = [_counted(len(seen.edges), "edge") + lost] if len(seen.edges) or lost else []
    return edges + [_counted(*each) for each in others if each[0]]


def _counted(count: int, name: str) -> str:
    return f"{count} {name}{'' if count == 1 else 's'}"
