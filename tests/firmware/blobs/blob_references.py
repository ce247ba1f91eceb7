"""What the blob detection must find, by flood fill and in plain Python; shares no code with the firmware.

Pictures are two-dimensional arrays of 32-bit words with at most one colour each; groups are masks of colours.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Picture = NDArray[Any]
Pixel = tuple[int, int]  # y, x: sorts in the order of the scan


@dataclass(frozen=True, slots=True)
class Blob:
    """A group of colours and the pixels that are connected in it."""

    colours: int
    pixels: list[Pixel]

    @property
    def words(self) -> list[int]:
        """The eight words of its t_Blob."""
        ys, xs = zip(*self.pixels, strict=True)
        count = len(self.pixels)
        record = struct.pack(
            "<4L8H",
            *(self.colours, count, sum(xs), sum(ys)),
            *(min(xs), max(xs), min(ys), max(ys)),
            *((min(xs) + max(xs)) // 2, (min(ys) + max(ys)) // 2),
            *((2 * sum(each) + count) // (2 * count) for each in (xs, ys)),  # rounded, halves upwards
        )
        return list(struct.unpack("<8L", record))


def segments(picture: Picture, groups: Sequence[int]) -> list[Blob]:
    """Return all segments of all groups, in the order of their first pixels."""
    found = [Blob(group, pixels) for group in groups for pixels in components(picture & group != 0)]
    return sorted(found, key=lambda each: each.pixels[0])


def components(mask: Picture) -> Iterator[list[Pixel]]:
    """Yield the sorted pixels of every 8-connected component of a mask, by flood fill."""
    left = {(int(y), int(x)) for y, x in np.argwhere(mask)}
    for first in sorted(left):
        if first not in left:
            continue  # another one has reached it
        left.remove(first)
        wave, pixels = [first], []
        while wave:
            y, x = wave.pop()
            pixels.append((y, x))
            near = {(y + dy, x + dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)} & left
            left -= near
            wave.extend(near)
        yield sorted(pixels)


@dataclass(frozen=True, slots=True)
class Labelled:
    """A picture without the runs that got no label, how many these were, and how many labels are taken at its end."""

    picture: Picture
    lost: int
    used: int


def labelled(
    picture: Picture, groups: Sequence[int], labels: int, recycle_at: int, min_pixels: int
) -> Labelled:
    """Leave out each run that touches no kept run of its group in the row above when all `labels` are taken.

    After a row with `recycle_at` labels or more, only segments in that row and those of `min_pixels` or more
    have one.
    """
    kept, lost, used = np.zeros_like(picture), 0, 0
    for y in range(len(picture)):
        for group, first, end in runs(picture[y], groups):
            above = kept[y - 1, max(first - 1, 0) : end + 1] if y else kept[:0]
            if not (above & group).any():
                if used == labels:
                    lost += 1
                    continue
                used += 1
            kept[y, first:end] = picture[y, first:end]
        if used >= recycle_at:
            found = segments(kept[: y + 1], groups)
            used = sum(each.pixels[-1][0] == y or len(each.pixels) >= min_pixels for each in found)
    return Labelled(kept, lost, used)


def runs(row: Picture, groups: Sequence[int]) -> list[tuple[int, int, int]]:
    """Return group, first column and the column behind the last one of a row's runs, from left to right."""
    found = []
    for group in groups:
        steps = np.diff((row & group != 0).astype(int), prepend=0, append=0)
        for first, end in zip(np.flatnonzero(steps > 0), np.flatnonzero(steps < 0), strict=True):
            found.append((group, int(first), int(end)))
    return sorted(found, key=lambda each: each[1])
