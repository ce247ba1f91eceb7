"""What in a memory map will cost time, or cannot work: findings with reasons and advice. None of them fails a link.

They use only what is known without a run, so a buffer of several rows counts as one that DMA streams.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from bfsim.report.ldf.bank_rules import STREAMED, own_banks, shared_banks
from bfsim.report.ldf.finding import Finding, listed
from bfsim.report.ldf.map import ContentKind, MapSegment, MapSymbol, MemoryMap

FULL_SHARE = 0.95
"""Segments with a larger used share are nearly full."""


def lint(memory_map: MemoryMap) -> tuple[Finding, ...]:
    """Return the findings of all rules, rule by rule."""
    return tuple(finding for rule in RULES for finding in rule(memory_map))


def _hot_code(memory_map: MemoryMap) -> Iterator[Finding]:
    """Find kernels outside L1 on a core whose code cache is off."""
    cached = {each.owner for each in memory_map.caches if each.memory.endswith("L1_CODE_CACHE")}
    for segment in memory_map.segments:
        code = [
            each for each in segment.symbols if each.kind is ContentKind.CODE and each.owner not in cached
        ]
        if code and "L1_CODE" not in segment.memory:
            yield Finding(
                rule="hot code outside L1",
                where=segment.name,
                reason=f"{listed([each.name for each in code])}, {_bytes(code)} of kernel code: every fetch goes "
                f"to {segment.memory}",
                advice="make room in L1_code and L1_code_cache, or turn the code cache on (___l1_code_cache = 1)",
            )


def _cached_halves(memory_map: MemoryMap) -> Iterator[Finding]:
    """Find symbols in the half of an L1 memory that the LDF turns into cache."""
    for cache in memory_map.caches:
        inside = [
            each
            for each in memory_map.symbols
            if each.address < cache.start + cache.nbytes and cache.start < each.address + each.nbytes
        ]
        streamed = [each for each in inside if each.kind in STREAMED]
        if inside:
            yield Finding(
                rule="DMA target in a cached half" if streamed else "symbols in a cached half",
                where=f"{cache.memory} from 0x{cache.start:08X}",
                reason=f"{listed([each.name for each in streamed or inside])}: the LDF makes this half cache, and "
                "then neither loads and stores nor DMA reach it as memory",
                advice="end the segment before it, or turn this cache off",
            )


def _scratchpad(memory_map: MemoryMap) -> Iterator[Finding]:
    """Find buffers of several rows in the scratchpad, which DMA cannot reach."""
    for segment in memory_map.segments:
        streamed = [each for each in segment.symbols if each.kind in STREAMED]
        if streamed and segment.memory.endswith("SCRATCH"):
            yield Finding(
                rule="DMA buffer in scratchpad",
                where=segment.name,
                reason=f"{listed([each.name for each in streamed])}: buffers of several rows, but no DMA reaches "
                "the scratchpad",
                advice="keep it for rows and rings that only kernels use; rings of DMA lines go to an L1 data bank",
            )


def _nearly_full(memory_map: MemoryMap) -> Iterator[Finding]:
    """Find segments without room, if no memory of the same speed for the same input sections has any."""
    for segment in memory_map.segments:
        if segment.used_share > FULL_SHARE and not any(
            _has_room_for(segment, each) for each in memory_map.segments
        ):
            yield Finding(
                rule="nearly full",
                where=segment.name,
                reason=f"{segment.free_bytes:,} of {segment.nbytes:,} bytes are free: the next buffer spills to a "
                "slower memory, or does not link",
                advice="move what is used least out of it",
            )


def _has_room_for(full: MapSegment, other: MapSegment) -> bool:
    """Whether the other segment takes everything that the full one does, is as fast, and has room."""
    as_fast = other.owner == full.owner and _level(other) == _level(full)
    return as_fast and other.used_share <= FULL_SHARE and _taken(full) <= _taken(other)


def _level(segment: MapSegment) -> str:
    return "L1" if "_L1_" in segment.memory else segment.memory


def _taken(segment: MapSegment) -> set[str]:
    return {name for section in segment.sections for name in section.takes}


def _tables(memory_map: MemoryMap) -> Iterator[Finding]:
    """Find tables in SDRAM that no data cache holds."""
    cached = {each.owner for each in memory_map.caches if "L1_DATA" in each.memory}
    for segment in memory_map.segments:
        tables = [
            each for each in segment.symbols if each.kind is ContentKind.TABLE and each.owner not in cached
        ]
        if tables and segment.memory == "SDRAM":
            yield Finding(
                rule="table in SDRAM",
                where=segment.name,
                reason=f"{listed([each.name for each in tables])}, {_bytes(tables)}: kernels look up single "
                "elements, and each one waits for the SDRAM",
                advice="tables of this size go to an L1 data bank, or to L2",
            )


RULES = (shared_banks, own_banks, _hot_code, _cached_halves, _scratchpad, _nearly_full, _tables)


def _bytes(symbols: Sequence[MapSymbol]) -> str:
    return f"{sum(each.nbytes for each in symbols):,} bytes"
