"""Blobs beside OpenCV's connected components, of the same opened colour images."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from benchmarks.quality.seen import Seen
from tinyphoon.stores.blobs import ACROSS, COLOURS, DOWN, PIXELS, SUM_X, SUM_Y
from tinyphoon.strategy.modes import INDOOR_FIELD

TITLE = "Blobs beside cv2.connectedComponentsWithStats"
COLUMNS = "ours", "OpenCV", "rectangle", "pixels", "centre", "lost", "runs lost"
NOTE = (
    "OpenCV's: components of each colour group, 8 neighbours, of the size of a blob. Behind them: how many of ours "
    "have one of the same rectangle, the same number of pixels too, the same centre of mass too, unrounded."
)


@dataclass(frozen=True, slots=True)
class Region:
    """A blob of ours or a component of OpenCV's; the rectangle is left, top, width and height."""

    colours: int
    rectangle: tuple[int, int, int, int]
    pixels: int
    centre: tuple[float, float]


def ours(seen: Seen) -> Iterator[Region]:
    """Yield the blobs that a core left in its store."""
    for record in seen.blobs.tolist():
        (left, right), (top, bottom) = (
            (record[word] & 0xFFFF, record[word] >> 16) for word in (ACROSS, DOWN)
        )
        rectangle = left, top, right - left + 1, bottom - top + 1
        centre = record[SUM_X] / record[PIXELS], record[SUM_Y] / record[PIXELS]
        yield Region(record[COLOURS], rectangle, record[PIXELS], centre)


def theirs(seen: Seen) -> Iterator[Region]:
    """Yield OpenCV's components that have the size of a blob."""
    sizes = range(INDOOR_FIELD.blobs.min_pixels, INDOOR_FIELD.blobs.max_pixels + 1)
    for colours in INDOOR_FIELD.blobs.colour_groups:
        mask = (seen.opened & colours != 0).astype(np.uint8)
        _, _, stats, centres = cv2.connectedComponentsWithStats(mask, connectivity=8)
        for (left, top, width, height, pixels), (x, y) in zip(
            stats[1:].tolist(), centres[1:].tolist(), strict=True
        ):
            if pixels in sizes:
                yield Region(colours, (left, top, width, height), pixels, (x, y))


def compare(found: Sequence[Region], reference: Sequence[Region]) -> Counter[str]:
    """Count the regions of both, and those of ours that the reference has as well, ever more exactly."""
    rectangles = {(each.colours, each.rectangle) for each in reference}
    sized = {(each.colours, each.rectangle, each.pixels) for each in reference}
    return Counter(
        {
            "ours": len(found),
            "OpenCV": len(reference),
            "rectangle": sum((each.colours, each.rectangle) in rectangles for each in found),
            "pixels": sum((each.colours, each.rectangle, each.pixels) in sized for each in found),
            "centre": sum(each in reference for each in found),
        }
    )


def cells(seen: Sequence[Seen]) -> Sequence[str]:
    """Return the numbers of a recording."""
    counts: Counter[str] = Counter()
    for each in seen:
        counts += compare(list(ours(each)), list(theirs(each)))
        counts += Counter({"lost": each.results["blobs_lost"], "runs lost": each.results["labels_lost"]})
    return [f"{counts[name]:,}" for name in COLUMNS]
