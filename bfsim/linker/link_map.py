"""What goes into the linker and what comes out: symbols, and the address of each of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from bfsim.errors import LinkError


@dataclass(frozen=True, slots=True)
class Symbol:
    """A variable or function: `nbytes` of the input section, from a multiple of `align` (a power of two).

    `processor` is "p0" (core A) or "p1" (core B), or None for what both cores share.
    """

    name: str
    section: str
    nbytes: int
    align: int = 4
    processor: str | None = None
    object_file: str = "firmware.doj"

    def __str__(self) -> str:
        """Name the symbol for an error message."""
        return f"symbol '{self.name}' of {self.processor or 'both cores'}"


@dataclass(frozen=True, slots=True)
class Placement:
    """Where a symbol went: its byte `address`, and the `line` of the INPUT_SECTIONS that took it."""

    symbol: Symbol
    segment: str
    output_section: str
    address: int
    line: int


@dataclass(frozen=True, slots=True)
class SegmentUsage:
    """How full a segment is: `used_bytes` counts symbols, reserves and the gaps that alignment leaves.

    For a reserve that expands, only the minimum counts.
    """

    name: str
    start: int
    nbytes: int
    used_bytes: int

    @property
    def free_bytes(self) -> int:
        """Bytes that are still free."""
        return self.nbytes - self.used_bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedReserve:
    """A RESERVE: `nbytes` from `start` of a segment; `length_name` is the symbol of its length.

    `processor` is None in memory that both cores share, `output_section` is empty for one with an address.
    """

    processor: str | None
    name: str
    length_name: str
    segment: str
    output_section: str
    start: int
    nbytes: int
    line: int


class LinkMap:
    """Every placement, in the order in which the segments were filled, and how full each segment is.

    `reserves` are the reserves in that order, those with an address first. `values` are the symbols that the LDF
    itself defines, by processor (None: for both) and name: starts and lengths of reserves, and assignments.
    """

    __slots__ = ("_by_name", "placements", "reserves", "segments", "values")

    def __init__(
        self,
        placements: Sequence[Placement],
        segments: Sequence[SegmentUsage],
        reserves: Sequence[PlacedReserve] = (),
        values: Mapping[tuple[str | None, str], int] = MappingProxyType({}),
    ) -> None:
        self.placements = tuple(placements)
        self.segments = tuple(segments)
        self.reserves = tuple(reserves)
        self.values = MappingProxyType(dict(values))
        self._by_name: Mapping[tuple[str | None, str], Placement] = {
            (placed.symbol.processor, placed.symbol.name): placed for placed in self.placements
        }

    def find(self, processor: str | None, name: str) -> Placement:
        """Return the placement of the processor's own or the shared symbol; raise LinkError if there is none."""
        placed = self._by_name.get((processor, name)) or self._by_name.get((None, name))
        if placed is None:
            raise LinkError(
                f"symbol must be one that was linked for {processor or 'both cores'}, not '{name}'"
            )
        return placed
