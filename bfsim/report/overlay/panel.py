"""One picture with the marks of everything seen in it."""

from __future__ import annotations

from dataclasses import replace

from PIL import Image

from bfsim.report.overlay import style
from bfsim.report.overlay.ground import picture_with_edges
from bfsim.report.overlay.labels import Label
from bfsim.report.overlay.pen import LOSS_DEPTH, Pen
from bfsim.seen import Seen, SeenEdges3D, SeenLine, SeenLine3D, SeenLoss, SeenObject, colours
from bfsim.seen.colours import DepthScale

LOSS_WEIGHT = 2  # above that of any object


def panel_of(
    seen: Seen,
    objects: tuple[SeenObject, ...],
    lines_3d: tuple[SeenLine3D, ...],
    edges_3d: tuple[SeenEdges3D, ...],
    scale: int,
    depths: DepthScale,
    hottest_us: float = 0.0,
) -> tuple[Image.Image, list[Label]]:
    """Return the picture of a camera with its marks, `scale` times larger, and the labels to write on it.

    `objects` are those that this camera shows; `lines_3d` and `edges_3d` are those of the left picture, and empty for
    the right one. `hottest_us`: the end of the scale of its heat.
    """
    under = Image.fromarray(picture_with_edges(seen, edges_3d, scale, depths, hottest_us))
    image = under.resize((under.width * style.SMOOTH, under.height * style.SMOOTH), Image.Resampling.NEAREST)
    pen = Pen(image, scale * style.SMOOTH)
    for loss in seen.losses:
        pen.loss(loss, seen.width_px)
    for blob in seen.blobs:
        pen.blob(blob)
    places = {each.left_line: each for each in lines_3d}
    worst = sorted(seen.losses, key=lambda each: -each.share)[:1]
    labels = [_loss_label(each, seen.width_px) for each in worst]
    for number, line in enumerate(seen.lines):
        depth_mm = _depth_of(places[number]) if number in places else None
        pen.line(line, colours.LINE if depth_mm is None else depths.colour(depth_mm))
        if depth_mm is not None:
            labels.append(_depth_label(line, depth_mm, depths))
    for circle in seen.circles:
        pen.circle(circle)
    for each in objects:
        pen.object(each)
        colour, weight = style.faded(each.colour, each.accuracy), each.accuracy - each.age_frames
        width, height = each.image_size_px
        box = {"width": width, "height": height, "weight": weight}
        labels.append(Label(*each.image_px, each.caption, colour, is_boxed=True, **box))
    for arrow in seen.arrows:
        pen.arrow(arrow)
        if arrow.text:
            labels.append(Label(*arrow.end_px, arrow.text, arrow.colour, is_boxed=True))
    labels += [Label(*each.place_px, each.text, each.colour, is_boxed=False) for each in seen.texts]
    return image.reduce(style.SMOOTH), [_scaled(each, scale) for each in labels]


def _scaled(label: Label, scale: int) -> Label:
    """Return a label in pixels of the panel."""
    return replace(
        label,
        x=(label.x + 0.5) * scale,
        y=(label.y + 0.5) * scale,
        width=label.width * scale,
        height=label.height * scale,
    )


def _depth_of(line: SeenLine3D) -> float:
    return (line.start_mm[2] + line.end_mm[2]) / 2


def _loss_label(loss: SeenLoss, width_px: int) -> Label:
    """Return a label for what is missing in a band of rows, beside its bar."""
    top, height = loss.top_px, loss.bottom_px + 1 - loss.top_px
    place = (
        LOSS_DEPTH * width_px / 2,
        top + height / 2 - 0.5,
        f"no room for {100 * loss.share:.0f} % of the {loss.what} here",
    )
    return Label(
        *place, colours.LOSS, is_boxed=True, width=LOSS_DEPTH * width_px, height=height, weight=LOSS_WEIGHT
    )


def _depth_label(line: SeenLine, depth_mm: float, depths: DepthScale) -> Label:
    x, y = ((line.start_px[axis] + line.end_px[axis]) / 2 for axis in (0, 1))
    return Label(x, y, f"{depth_mm:.0f}", depths.colour(depth_mm), is_boxed=False)
