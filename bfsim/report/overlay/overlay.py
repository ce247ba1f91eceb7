"""What was seen in a frame, drawn over its pictures: the cameras side by side on a dark sheet, with a legend."""

from __future__ import annotations

from PIL import Image, ImageDraw

from bfsim.report.overlay import style
from bfsim.report.overlay.legend import legend
from bfsim.report.overlay.panel import Label, panel_of
from bfsim.seen import Seen, SeenFrame

BOX_PAD = 4
HALO = 2  # of words without a box

Box = tuple[float, float, float, float]
"""Left, top, right, bottom."""


def overlay_of(frame: SeenFrame) -> Image.Image:
    """Return the sheet of a frame, RGB: the same size for frames of pictures of one size."""
    wanted_px = style.PANEL_WIDTH if len(frame.cameras) > 1 else legend().width
    panels = [_panel(frame, each, wanted_px) for each in frame.cameras]
    inside = sum(image.width for image, _ in panels) + style.MARGIN * (len(panels) - 1)
    width = 2 * style.MARGIN + max(inside, legend().width)
    height = style.HEAD + max(image.height for image, _ in panels) + style.FOOT
    sheet = Image.new("RGB", (width, height), style.PAPER)
    pen = ImageDraw.Draw(sheet)
    left = style.MARGIN
    for seen, (image, labels) in zip(frame.cameras, panels, strict=True):
        sheet.paste(image, (left, style.HEAD))
        _write_head(pen, frame, seen, left, image.width)
        _write_labels(pen, labels, (left, style.HEAD, left + image.width, style.HEAD + image.height))
        left += image.width + style.MARGIN
    sheet.paste(legend(), (style.MARGIN, height - style.FOOT))
    return sheet


def _panel(frame: SeenFrame, seen: Seen, wanted_px: int) -> tuple[Image.Image, list[Label]]:
    scale = max(1, round(wanted_px / seen.width_px))
    objects = tuple(each for each in frame.objects if each.camera == seen.camera)
    if seen.camera != "left":
        return panel_of(seen, objects, (), (), scale)
    return panel_of(seen, objects, frame.lines_3d, tuple(frame.edges_3d()), scale)


def _write_head(pen: ImageDraw.ImageDraw, frame: SeenFrame, seen: Seen, left: int, width: int) -> None:
    font, middle = style.font(style.FONT), style.HEAD // 2
    title = f"{seen.camera} camera"
    pen.text((left, middle), title, style.WORDS, font, anchor="lm")
    when = f"frame {frame.index}   {frame.times_ns[seen.camera] / 1e9:.3f} s"
    pen.text((left + font.getlength(title) + style.MARGIN, middle), when, style.FAINT, font, anchor="lm")
    lost = f" and {seen.edges.lost} lost" if seen.edges.lost else ""
    counts = (
        _counted(len(seen.edges), "edge") + lost,
        _counted(len(seen.blobs), "blob"),
        _counted(len(seen.lines), "line"),
        _counted(sum(each.passed for each in seen.circles), "circle"),
    )
    text = "   ".join(counts)
    pen.text((left + width, middle), text, style.FAINT, font, anchor="rm")


def _counted(count: int, name: str) -> str:
    return f"{count} {name}{'' if count == 1 else 's'}"


def _write_labels(pen: ImageDraw.ImageDraw, labels: list[Label], panel: Box) -> None:
    """Write labels where they belong, inside of the panel: boxes make room for each other, depths are left out."""
    taken: list[Box] = []
    for each in sorted(labels, key=lambda label: not label.is_boxed):
        font = style.font(style.LABEL_FONT if each.is_boxed else style.DEPTH_FONT)
        box = _box_of(each, pen.textlength(each.text, font), panel)
        height = box[3] - box[1]
        while each.is_boxed and _meets(box, taken) and box[3] + height < panel[3]:
            box = (box[0], box[1] + height + 1, box[2], box[3] + height + 1)
        if not each.is_boxed and _meets(box, taken):
            continue
        taken.append(box)
        if each.is_boxed:
            pen.rounded_rectangle(box, BOX_PAD, fill=style.PAPER, outline=each.colour)
        place = (box[0] + box[2]) / 2, (box[1] + box[3]) / 2
        pen.text(place, each.text, each.colour, font, anchor="mm", stroke_width=HALO, stroke_fill=style.PAPER)


def _box_of(label: Label, length: float, panel: Box) -> Box:
    """Return where a label goes, whatever else is there: above its place, or in its middle without a box."""
    left, top, right, bottom = panel
    width, height = length + 2 * BOX_PAD, style.LABEL_FONT + 2 * BOX_PAD
    above = height + 2 * BOX_PAD if label.is_boxed else height / 2
    x = min(max(left + label.x - width / 2, left), right - width)
    y = min(max(top + label.y - above, top), bottom - height)
    return x, y, x + width, y + height


def _meets(box: Box, others: list[Box]) -> bool:
    return any(
        box[0] < other[2] and other[0] < box[2] and box[1] < other[3] and other[1] < box[3]
        for other in others
    )
