"""Arrange a link by address: the linker's result, the board's memories and the LDF's switches → a MemoryMap."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter

from bfsim.chip.memory_map import Region, regions_under
from bfsim.errors import ConfigError
from bfsim.linker import LinkerScript, LinkMap, PlacedReserve, Placement
from bfsim.linker.script import Block, FixedReserve, InputSections, OutputSection, Segment
from bfsim.report.ldf.caches import caches_of
from bfsim.report.ldf.map import SHARED, ContentKind, MapPiece, MapSection, MapSegment, MapSymbol, MemoryMap
from bfsim.report.ldf.pieces import pieces_of


@dataclass(frozen=True, slots=True, kw_only=True)
class BoardMemories:
    """What the map needs of a board: its memories, none if they are unknown, and how its SDRAM is divided."""

    board: str
    regions: Sequence[Region]
    bank_bytes: int


def memory_map(
    script: LinkerScript,
    link_map: LinkMap | None,
    memories: BoardMemories,
    kinds: Mapping[tuple[str | None, str], ContentKind],
    *,
    firmware: str,
    width_px: int,
    height_px: int,
    why_without: str = "",
) -> MemoryMap:
    """Return the map of `script` as filled by `link_map`, or empty without one, for the reason `why_without`.

    `kinds`: the kinds of symbols, by processor (None: both) and name; all other symbols are code.
    """
    builder = _Builder(script, link_map, memories, kinds)
    return MemoryMap(
        ldf=script.path.name,
        firmware=firmware,
        board=memories.board,
        width_px=width_px,
        height_px=height_px,
        segments=tuple(builder.segment(each) for each in script.segments),
        caches=tuple(caches_of(script, memories.regions)),
        why_without=why_without,
    )


class _Builder:
    """Makes the parts of one map."""

    def __init__(
        self,
        script: LinkerScript,
        link_map: LinkMap | None,
        memories: BoardMemories,
        kinds: Mapping[tuple[str | None, str], ContentKind],
    ) -> None:
        self.script = script
        self.memories = memories
        self.kinds = kinds
        placements = link_map.placements if link_map else ()
        reserves: Sequence[PlacedReserve | FixedReserve] = link_map.reserves if link_map else script.reserves
        self._used = {each.name: each.used_bytes for each in link_map.segments} if link_map else {}
        self._placed = sorted(placements, key=lambda each: each.address)
        self._reserved = sorted(reserves, key=lambda each: each.start)
        self._outputs: dict[str, list[tuple[Block, OutputSection]]] = {}
        for block in script.blocks:
            for output in block.output_sections:
                self._outputs.setdefault(output.segment, []).append((block, output))

    def segment(self, segment: Segment) -> MapSegment:
        """Return one segment with its symbols, under any name of the same memory."""
        memory, owner = self.memory(segment)
        start, end = segment.start, segment.end + 1
        address = attrgetter("address")
        placed = self._placed[
            bisect_left(self._placed, start, key=address) : bisect_left(self._placed, end, key=address)
        ]
        reserves = list(self.reserves(segment))
        symbols = tuple(self.symbol(each, memory) for each in placed)
        used = self._used.get(segment.name, sum(each.nbytes for each in reserves))
        return MapSegment(
            name=segment.name,
            memory=memory,
            owner=owner,
            start=segment.start,
            nbytes=segment.nbytes,
            used_bytes=used,
            sections=tuple(self.sections(segment, placed)),
            symbols=symbols,
            pieces=tuple(pieces_of(segment, used, symbols, reserves)),
        )

    def memory(self, segment: Segment) -> tuple[str, str]:
        """Return the name of the memory or memories under a segment, and its owner."""
        if not self.memories.regions:
            return "unknown", SHARED
        try:
            first, *others = regions_under(segment.start, segment.nbytes, self.memories.regions)
        except ConfigError:
            return "no memory of the board", SHARED
        more = (each.memory.removeprefix(f"{first.memory}_") for each in others)  # L1_CODE+CACHE
        return "+".join((first.name, *more)), str(first.owner)

    def symbol(self, placed: Placement, memory: str) -> MapSymbol:
        """Return one symbol in its place."""
        symbol, bank_bytes = placed.symbol, self.memories.bank_bytes
        last = placed.address + max(symbol.nbytes, 1) - 1
        in_sdram = memory == "SDRAM"
        return MapSymbol(
            name=symbol.name,
            kind=self.kinds.get((symbol.processor, symbol.name), ContentKind.CODE),
            owner=self.script.core_of_processor[symbol.processor] if symbol.processor else SHARED,
            section=symbol.section,
            nbytes=symbol.nbytes,
            address=placed.address,
            output_section=placed.output_section,
            line=placed.line,
            banks=tuple(range(placed.address // bank_bytes, last // bank_bytes + 1)) if in_sdram else (),
        )

    def sections(self, segment: Segment, placements: Sequence[Placement]) -> Iterator[MapSection]:
        """Yield the output sections of a segment, in the order in which they fill it."""
        for block, output in self._outputs.get(segment.name, ()):
            statements = [each for each in output.statements if isinstance(each, InputSections)]
            lines = {each.line for each in statements}
            inside = [p for p in placements if p.output_section == output.name and p.line in lines]
            yield MapSection(
                name=output.name,
                block=block.title,
                line=output.line,
                takes=tuple(_takes(statements)),
                symbols=len(inside),
                nbytes=sum(each.symbol.nbytes for each in inside),
            )

    def reserves(self, segment: Segment) -> Iterator[MapPiece]:
        """Yield the reserves in a segment; without a link, only those that have an address."""
        start = attrgetter("start")
        first = bisect_left(self._reserved, segment.start, key=start)
        last = bisect_left(self._reserved, segment.end + 1, key=start)
        inside = {each.start: each for each in self._reserved[first:last]}
        for each in inside.values():
            yield MapPiece(
                name=each.name, kind=ContentKind.RESERVED, owner=SHARED, start=each.start, nbytes=each.nbytes
            )


def _takes(statements: Sequence[InputSections]) -> Iterator[str]:
    """Yield each input section once, at its first mention; those of one list in alphabetical order."""
    names = [name for each in statements for part in each.inputs for name in sorted(part.sections)]
    yield from dict.fromkeys(names)
