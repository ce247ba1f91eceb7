"""The memories of an LDF for the integer programme: contiguous stretches with their sizes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

from bfsim.chip.memory_map import Region
from bfsim.linker import LinkerScript
from bfsim.linker.filling import Filling, align_up
from bfsim.linker.memory_checks import region_under
from bfsim.linker.script import Reserve, Segment


class Level(StrEnum):
    """How far a memory is from the core; the slowest comes first, and the one without DMA last."""

    SDRAM = "SDRAM"
    L2 = "L2"
    L1 = "L1"
    L1_CODE = "L1 code"
    SCRATCH = "scratchpad"

    @property
    def rank(self) -> int:
        """Number of the level, 0 for the slowest."""
        return tuple(Level).index(self)


LEVELS = {
    "SDRAM": Level.SDRAM,
    "L2": Level.L2,
    "SCRATCH": Level.SCRATCH,
    "L1_DATA_A": Level.L1,
    "L1_DATA_B": Level.L1,
    "L1_CODE": Level.L1_CODE,
    "L1_CODE_CACHE": Level.L1_CODE,
}
"""The level of each memory of a chip; banks of asynchronous memory have none, and nothing is placed there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """A part of a segment between two reserves. `owner`: the core that reaches it, or "shared". `start` is aligned."""

    segment: Segment
    level: Level
    owner: str
    start: int
    nbytes: int
    align: int

    def takes(self, *, owner: str, is_code: bool) -> bool:
        """Whether code, or a buffer, of a core or of both can lie here."""
        is_reached = self.owner in ("shared", owner)
        return (
            is_reached
            and self.level is not (Level.L1 if is_code else Level.L1_CODE)
            and not (is_code and self.level is Level.SCRATCH)
        )


def stretches_of(script: LinkerScript, regions: Sequence[Region], line_bytes: int) -> tuple[Stretch, ...]:
    """Return the free stretches of each segment that an LDF fills, by address. In SDRAM they begin on cache lines."""
    filled = {output.segment for block in script.blocks for output in block.output_sections}
    segments = [each for each in script.segments if each.name in filled]
    by_start = {each.start: each for each in reversed(segments)}  # several cores may name one memory
    return tuple(
        stretch
        for start in sorted(by_start)
        for stretch in _stretches(script, by_start[start], regions, line_bytes)
    )


def reserves_in(script: LinkerScript, start: int) -> Iterator[Reserve]:
    """Yield the reserves without an address in the segment that begins at `start`, in the order of the LDF."""
    for block in script.blocks:
        for output in block.output_sections:
            if output.segment and script.segment_by_name[output.segment].start == start:
                yield from (each for each in output.statements if isinstance(each, Reserve))


def _stretches(
    script: LinkerScript, segment: Segment, regions: Sequence[Region], line_bytes: int
) -> Iterator[Stretch]:
    region = region_under(segment, regions)
    if region.memory not in LEVELS:
        return
    level = LEVELS[region.memory]
    align = line_bytes if level is Level.SDRAM else 4
    fixed = [each for each in script.reserves if segment.start <= each.start <= segment.end]
    filling = Filling(segment, fixed)
    for each in reserves_in(script, segment.start):
        filling.take(each.nbytes, each.align)
    start = filling.location
    for reserved in sorted({(each.start, each.nbytes) for each in fixed} | {(segment.end + 1, 0)}):
        nbytes = reserved[0] - align_up(start, align)
        if nbytes > 0:
            yield Stretch(
                segment=segment,
                level=level,
                owner=region.owner,
                start=align_up(start, align),
                nbytes=nbytes,
                align=align,
            )
        start = max(start, sum(reserved))
