"""Which blobs are parts of one thing, in plain Python; shares no code with the kernels.

Blobs are dictionaries of colours, pixels, left, right, top, bottom; circles of x, y, radius (1/16 px), blob and tests.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from tests.firmware.objects.object_references import sides, within
from tests.firmware.objects.place_references import GOAL, Record

PASSED = 3


@dataclass(slots=True)
class Blobs:
    """All blobs, with merged ones; what each is part of; and how many merged ones there would be with room for them."""

    records: list[Record]
    parents: list[int]
    room: int
    wanted: int = 0

    def merge(self, parts: Iterable[int]) -> None:
        """Make one of several, if there is room."""
        self.wanted += 1
        number = len(self.records)
        if number < self.room:
            self.records.append(whole([self.records[each] for each in parts]))
            self.parents.append(number)
            for each in parts:
                self.parents[each] = number

    def alone(self, colours: int) -> list[int]:
        """Those of some colours that are part of themselves only."""
        return [
            number
            for number, blob in enumerate(self.records)
            if self.parents[number] == number and blob["colours"] == colours
        ]


def merged(
    blobs: Sequence[Record], circles: Sequence[Record], models: Sequence[Any], room: int
) -> tuple[Blobs, list[int]]:
    """The blobs, and the blob of each circle."""
    all_blobs = Blobs(list(blobs), list(range(len(blobs))), room)
    owners = [each["blob"] for each in circles]
    merged_before = len(blobs)
    for number, circle in enumerate(circles):
        if circle["tests"] == PASSED and _merge_within(all_blobs, circle, merged_before):
            owners[number] = len(all_blobs.records) - 1
    balls = {
        each["blob"]
        for each, owner in zip(circles, owners, strict=True)
        if owner == each["blob"]
        and each["tests"] == PASSED
        and within(blobs[owner], each)
        and fills_half(blobs[owner]["pixels"], each)
    }
    for model in models:
        if model.shape == GOAL:
            free = [
                each for each in all_blobs.alone(model.colours) if each < len(blobs) and each not in balls
            ]
            _merge_goal(all_blobs, free, model.aspect_max)
    return all_blobs, owners


def _merge_within(blobs: Blobs, circle: Record, count: int) -> bool:
    """Merge the blob of a circle with others in it; whether that was right and there was room."""
    alone = blobs.alone(blobs.records[circle["blob"]]["colours"])
    parts = [each for each in alone if each < count and within(blobs.records[each], circle)]
    pixels = sum(blobs.records[each]["pixels"] for each in parts)
    if circle["blob"] not in parts or len(parts) == 1 or not fills_half(pixels, circle):
        return False
    before = len(blobs.records)
    blobs.merge(parts)
    return len(blobs.records) > before


def _merge_goal(blobs: Blobs, free: Sequence[int], aspect_max: int) -> None:
    """Merge the largest of the free blobs with those beside it, the nearest first."""
    if not free:
        return
    parts = [max(free, key=lambda each: (blobs.records[each]["pixels"], -each))]
    while True:
        so_far = whole([blobs.records[each] for each in parts])
        gaps = {
            each: gap_beside(so_far, blobs.records[each], aspect_max) for each in free if each not in parts
        }
        near = [(gap, each) for each, gap in gaps.items() if gap is not None]
        if not near:
            break
        parts.append(min(near)[1])
    if len(parts) > 1:
        blobs.merge(parts)


def whole(parts: Sequence[Record]) -> Record:
    """One blob of all pixels of several."""
    picks = {"left": min, "top": min, "right": max, "bottom": max, "pixels": sum}
    return parts[0] | {name: pick([each[name] for each in parts]) for name, pick in picks.items()}


def fills_half(pixels: int, circle: Record) -> bool:
    """Whether so many pixels are half of the disc, to whole pixels of its diameter."""
    return 512 * pixels >= 201 * (2 * circle["radius"] // 16) ** 2


def gap_beside(one: Record, other: Record, aspect_max: int) -> int | None:
    """Columns between two blobs side by side; None if they are not, or wider together than a model may be."""
    common = min(one["bottom"], other["bottom"]) + 1 - max(one["top"], other["top"])
    both = whole([one, other])
    if 2 * common < min(sides(one)[1], sides(other)[1]) or 16 * sides(both)[0] > aspect_max * sides(both)[1]:
        return None
    return max(sides(both)[0] - sides(one)[0] - sides(other)[0], 0)
