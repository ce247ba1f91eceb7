"""What in a memory map will cost time, or cannot work: findings with a reason and advice. Nothing here fails a link.

All is judged from what is known without a run, so a buffer of several rows counts as one that DMA streams.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from bfsim.report.ldf.map import SHARED, ContentKind, MapSegment, MapSymbol, MemoryMap

FULL_SHARE = 0.95
"""A segment that is used beyond this share is nearly full."""

NAMES_LISTED = 4
STREAMED = (ContentKind.CAMERA, ContentKind.LINES)


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One thing to look at: the `rule` that found it, `where`, why it matters and what to do about it."""

    rule: str
    where: str
    reason: str
    advice: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Stream:
    """A buffer that a `master` fills or empties line by line, in the `banks` of the SDRAM.

    Streams of different masters run at the same time. One core's memory DMA is one master: it has an inward and an
    outward stream, but which of its buffers these take together is known to its main loop only.
    """

    buffer: str
    master: str
    banks: tuple[int, ...]


def lint(memory_map: MemoryMap) -> tuple[Finding, ...]:
    """Return the findings of all rules, rule by rule."""
    return tuple(finding for rule in RULES for finding in rule(memory_map))


def streams_of(symbols: Iterable[MapSymbol]) -> list[Stream]:
    """Return the streams to and from SDRAM that a firmware's buffers suggest."""
    return [
        Stream(buffer=each.name, master=_master(each), banks=each.banks)
        for each in symbols
        if each.banks and each.kind in STREAMED
    ]


def _master(symbol: MapSymbol) -> str:
    if symbol.kind is ContentKind.CAMERA:
        return f"camera {symbol.owner}"
    return "both cores" if symbol.owner == SHARED else f"core {symbol.owner}"


def streams_by_bank(streams: Sequence[Stream]) -> Mapping[int, Sequence[Stream]]:
    """Return which streams run in which bank, by the number of the bank."""
    banks = sorted({bank for each in streams for bank in each.banks})
    return {bank: [each for each in streams if bank in each.banks] for bank in banks}


def _shared_banks(memory_map: MemoryMap) -> Iterator[Finding]:
    """Find banks in which several masters stream: they do so at the same time, whatever the firmware does."""
    by_bank = streams_by_bank(streams_of(memory_map.symbols))
    for bank, streams in by_bank.items():
        if len({each.master for each in streams}) > 1:
            yield Finding(
                rule="streams share a bank",
                where=f"SDRAM bank {bank}",
                reason=f"{_buffers_by_master(streams)} stream through it at the same time; a bank keeps one page "
                "open, so each closes the other's page, and most bursts begin with a page conflict",
                advice=_other_bank(memory_map, by_bank),
            )


def _own_banks(memory_map: MemoryMap) -> Iterator[Finding]:
    """Find banks with two buffers of one master: it depends on the main loop whether both stream at a time."""
    for bank, streams in streams_by_bank(streams_of(memory_map.symbols)).items():
        if len(streams) > 1 and len({each.master for each in streams}) == 1:
            yield Finding(
                rule="images share a bank",
                where=f"SDRAM bank {bank}",
                reason=f"{_buffers_by_master(streams)} lie in it; a stage that reads one of them while it writes "
                "another opens a page for every line",
                advice="give what one stage reads and writes two banks, if the other streams leave one free",
            )


def _buffers_by_master(streams: Sequence[Stream]) -> str:
    ordered = sorted(streams, key=lambda each: each.master)
    parts = [
        f"{_listed([each.buffer for each in group])} of {master}"
        for master, group in groupby(ordered, key=lambda each: each.master)
    ]
    return " and ".join(parts)


def _other_bank(memory_map: MemoryMap, by_bank: Mapping[int, Sequence[Stream]]) -> str:
    free = [
        f"{segment.name} ({', '.join(takes)})"
        for segment in memory_map.segments
        if segment.memory == "SDRAM" and not any(each.kind in STREAMED for each in segment.symbols)
        for takes in [[name for section in segment.sections for name in section.takes]]
        if takes
    ]
    if free:
        return f"no stream runs in {', '.join(free)}: move one there by its input section"
    if len(by_bank) > 1:
        return "move one to the bank whose streams move least, or its lines to L1 or L2"
    return "give the LDF a segment for each internal bank, and each stream one of them"


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
                reason=f"{_listed([each.name for each in code])}, {_bytes(code)} of kernel code: every fetch goes "
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
                reason=f"{_listed([each.name for each in streamed or inside])}: the LDF makes this half cache, and "
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
                reason=f"{_listed([each.name for each in streamed])}: buffers of several rows, but no DMA reaches "
                "the scratchpad",
                advice="keep it for rows and rings that only kernels use; rings of DMA lines go to an L1 data bank",
            )


def _nearly_full(memory_map: MemoryMap) -> Iterator[Finding]:
    """Find segments with no room left, and none in a memory as fast that takes the same input sections."""
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
    """Say whether the other segment takes all that the full one does, is as fast, and has room."""
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
                reason=f"{_listed([each.name for each in tables])}, {_bytes(tables)}: kernels look up single "
                "elements, and each one waits for the SDRAM",
                advice="tables of this size go to an L1 data bank, or to L2",
            )


RULES = (_shared_banks, _own_banks, _hot_code, _cached_halves, _scratchpad, _nearly_full, _tables)


def _listed(names: Sequence[str]) -> str:
    """Return the names without doubles, the first few of many."""
    unique = list(dict.fromkeys(names))
    more = len(unique) - NAMES_LISTED
    if more > 0:
        return f"{', '.join(unique[:NAMES_LISTED])} and {more} more"
    return ", ".join(unique[:-1]) + " and " * (len(unique) > 1) + unique[-1]


def _bytes(symbols: Sequence[MapSymbol]) -> str:
    return f"{sum(each.nbytes for each in symbols):,} bytes"
