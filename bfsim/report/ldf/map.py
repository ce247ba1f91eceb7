"""The memory map of one link as records: what lies where in each segment of an LDF, and what is still free.

`map_builder.memory_map` makes it. Tables, picture and lint read nothing but these records.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

SHARED = "shared"
"""Owner of memory that every core reaches."""


class ContentKind(StrEnum):
    """The content of a stretch of memory, as far as it is known without a run."""

    CODE = "code"
    CAMERA = "camera"  # the PPI fills it
    LINES = "lines"  # a buffer of more than one row: an image, or a ring
    ROW = "row"
    TABLE = "table"  # constants that come with the firmware
    RESERVED = "reserved"  # RESERVE, and the gaps that alignment leaves
    FREE = "free"


@dataclass(frozen=True, slots=True, kw_only=True)
class MapSymbol:
    """A symbol in its place. `banks` are the internal banks of the SDRAM that it lies in, none elsewhere.

    `line` is the line of the LDF that placed it. `owner` is a core, or "shared".
    """

    name: str
    kind: ContentKind
    owner: str
    section: str
    nbytes: int
    address: int
    output_section: str
    line: int
    banks: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class MapPiece:
    """A stretch of a segment: one buffer, adjacent code of one core, a reserve, or free space."""

    name: str
    kind: ContentKind
    owner: str
    start: int
    nbytes: int

    @property
    def is_named(self) -> bool:
        """Whether it contains a symbol."""
        return self.kind not in (ContentKind.FREE, ContentKind.RESERVED)


@dataclass(frozen=True, slots=True, kw_only=True)
class MapSection:
    """An output section: the input sections that it takes, in the order in which it asks for them."""

    name: str
    block: str
    line: int
    takes: tuple[str, ...]
    symbols: int
    nbytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class MapSegment:
    """A memory segment of the LDF, in the board's `memory`. `used_bytes` counts symbols, reserves and gaps.

    `pieces` fill it from start to end. A reserve that expands into free space counts with its minimum only.
    """

    name: str
    memory: str
    owner: str
    start: int
    nbytes: int
    used_bytes: int
    sections: tuple[MapSection, ...]
    symbols: tuple[MapSymbol, ...]
    pieces: tuple[MapPiece, ...]

    @property
    def free_bytes(self) -> int:
        """Bytes that are still free."""
        return self.nbytes - self.used_bytes

    def label(self, piece: MapPiece) -> str:
        """Return the name of a piece, followed by its core if it does not belong to the segment's owner."""
        return piece.name if piece.owner in (SHARED, self.owner) else f"{piece.name} ({piece.owner})"

    @property
    def used_share(self) -> float:
        """Used part of the segment, 0..1."""
        return self.used_bytes / self.nbytes


@dataclass(frozen=True, slots=True, kw_only=True)
class CacheRange:
    """A stretch of L1 that the LDF turns into cache; nothing else can be there."""

    memory: str
    owner: str
    start: int
    nbytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class MemoryMap:
    """An LDF with the symbols of a firmware in it; without `firmware` the LDF alone, and `why_without`."""

    ldf: str
    firmware: str
    board: str
    width_px: int
    height_px: int
    segments: tuple[MapSegment, ...]
    caches: tuple[CacheRange, ...]
    why_without: str = ""

    @property
    def symbols(self) -> tuple[MapSymbol, ...]:
        """All symbols, segment by segment."""
        return tuple(symbol for segment in self.segments for symbol in segment.symbols)
