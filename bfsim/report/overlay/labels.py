"""Words on a picture: each beside what it names, without overlaps, and at most one at a place."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from PIL import ImageDraw

from bfsim.report.overlay import style
from bfsim.report.wording.letters import in_letters_of_pillow
from bfsim.seen import Colour

PAD = 4
HALO = 2  # around words without a box

Box = tuple[float, float, float, float]
"""Left, top, right, bottom."""


@dataclass(frozen=True, slots=True)
class Label:
    """Words for something at a place of a panel, in pixels: in a box beside it, or without a box on its middle.

    `width` and `height` are those of the named thing. Labels of greater `weight` are placed first.
    """

    x: float
    y: float
    text: str
    colour: Colour
    is_boxed: bool
    width: float = 0
    height: float = 0
    weight: float = 0

    @property
    def named(self) -> Box:
        """The box of the named thing."""
        return (
            self.x - self.width / 2,
            self.y - self.height / 2,
            self.x + self.width / 2,
            self.y + self.height / 2,
        )


def write_labels(pen: ImageDraw.ImageDraw, labels: Sequence[Label], panel: Box) -> None:
    """Write labels into a panel, from whose top left corner their places count; those without room are left out.

    Boxes go above, below or beside the named thing, and cover neither another box nor a named thing. If a label of
    greater weight names something at the same place, a label is left out.
    """
    named = _one_a_place([each for each in labels if each.is_boxed])
    kept = [_in(panel, each.named) for each in named]
    taken: list[Box] = []
    for each in (*named, *(each for each in labels if not each.is_boxed)):
        font = style.font(style.LABEL_FONT if each.is_boxed else style.DEPTH_FONT)
        text = in_letters_of_pillow(each.text)
        size = pen.textlength(text, font) + 2 * PAD, style.LABEL_FONT + 2 * PAD
        free = (box for box in _places(each, size, panel) if not _meets(box, taken))
        if each.is_boxed:
            free = (box for box in free if not _meets(box, kept))
        box = next(free, None)
        if box is None:
            continue
        taken.append(box)
        if each.is_boxed:
            pen.rounded_rectangle(box, PAD, fill=style.PAPER, outline=each.colour)
        place = (box[0] + box[2]) / 2, (box[1] + box[3]) / 2
        pen.text(place, text, each.colour, font, anchor="mm", stroke_width=HALO, stroke_fill=style.PAPER)


def _one_a_place(labels: Sequence[Label]) -> list[Label]:
    """Return the labels by weight, without those that share their place with one before them.

    Two labels share a place if the middle of one lies in what the other names.
    """
    kept: list[Label] = []
    for each in sorted(labels, key=lambda label: -label.weight):
        if not any(_holds(other.named, each) or _holds(each.named, other) for other in kept):
            kept.append(each)
    return kept


def _holds(box: Box, label: Label) -> bool:
    return box[0] <= label.x <= box[2] and box[1] <= label.y <= box[3]


def _places(label: Label, size: tuple[float, float], panel: Box) -> Iterator[Box]:
    """Yield possible places of a label, the best first."""
    width, height = size
    left, top, right, bottom = _in(panel, label.named)
    x, y = (left + right) / 2, (top + bottom) / 2
    corners = [(x - width / 2, y - height / 2)]
    if label.is_boxed:
        above, below = top - height - 2 * PAD, bottom + 2 * PAD
        beside = [(right + 2 * PAD, y - height / 2), (left - width - 2 * PAD, y - height / 2)]
        corners = [(x - width / 2, above), (x - width / 2, below), *beside]
        # one pixel further away on either side, if the places before are taken
        corners += [(x - width / 2, above - height - 1), (x - width / 2, below + height + 1)]
    for corner in corners:
        at_x = min(max(corner[0], panel[0]), panel[2] - width)
        at_y = min(max(corner[1], panel[1]), panel[3] - height)
        yield at_x, at_y, at_x + width, at_y + height


def _in(panel: Box, box: Box) -> Box:
    return box[0] + panel[0], box[1] + panel[1], box[2] + panel[0], box[3] + panel[1]


def _meets(box: Box, others: Sequence[Box]) -> bool:
    return any(
        box[0] < other[2] and other[0] < box[2] and box[1] < other[3] and other[1] < box[3]
        for other in others
    )
