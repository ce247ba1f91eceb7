"""The settings of a sweep, each over all of its recordings, the fastest first."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from statistics import median_low

from bfsim.report.sweep.figures import FRAME_RATE, FRAME_TIME, LATENCY, MISSED, ON_CHIP, WORST_FRAME
from bfsim.report.sweep.table import Row

RATE_SHARE = 0.002
"""Rates of firmware that waits for pictures differ by up to this share: it depends on when waits begin and end."""


@dataclass(frozen=True, slots=True)
class Shown:
    """A point: the name of its setting, its own name, and its row of the table."""

    setting: str
    name: str
    row: Row


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """A setting over its recordings: the least rate, medians of frame time and latency, the maximum of the rest."""

    name: str
    recordings: int
    frame_rate_hz: float
    frame_ms: float
    worst_ms: float
    latency_ms: float
    on_chip_bytes: float
    missed: float


def lines_of(points: Iterable[Shown]) -> list[Line]:
    """Return a line for each setting of finished points, the fastest first; among equals, the shortest frames first."""
    by_name = defaultdict[str, list[Row]](list)
    for each in points:
        by_name[each.setting].append(each.row)
    lines = [
        Line(
            name=name,
            recordings=len(group),
            frame_rate_hz=min(_numbers(group, FRAME_RATE)),
            frame_ms=median_low(_numbers(group, FRAME_TIME)),
            worst_ms=max(_numbers(group, WORST_FRAME)),
            latency_ms=median_low(_numbers(group, LATENCY)),
            on_chip_bytes=max(_numbers(group, ON_CHIP)),
            missed=sum(_numbers(group, MISSED)),
        )
        for name, group in by_name.items()
    ]
    return list(_ranked(sorted(lines, key=lambda each: -each.frame_rate_hz)))


def _ranked(lines: Sequence[Line]) -> Iterator[Line]:
    """Yield lines sorted by rate; where rates differ only by how pictures come, shorter frames come first."""
    rest = list(lines)
    while rest:
        alike = [each for each in rest if each.frame_rate_hz >= (1 - RATE_SHARE) * rest[0].frame_rate_hz]
        yield from sorted(alike, key=lambda each: each.frame_ms)
        rest = rest[len(alike) :]


def _numbers(rows: Iterable[Row], column: str) -> list[float]:
    return [float(row[column] or 0) for row in rows]
