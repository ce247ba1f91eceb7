"""Findings about the banks of the SDRAM: which masters stream through a bank at the same time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from bfsim.report.ldf.finding import Finding, listed
from bfsim.report.ldf.map import SHARED, ContentKind, MapSymbol, MemoryMap

STREAMED = (ContentKind.CAMERA, ContentKind.LINES)


@dataclass(frozen=True, slots=True, kw_only=True)
class Stream:
    """A buffer that a `master` fills or empties line by line, in the `banks` of the SDRAM.

    Streams of different masters run at the same time. A core's memory DMA is one master: it has an inward and an
    outward stream, but only the main loop knows which of its buffers these use together.
    """

    buffer: str
    master: str
    banks: tuple[int, ...]


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
    """Return the streams that run in each bank, by the number of the bank."""
    banks = sorted({bank for each in streams for bank in each.banks})
    return {bank: [each for each in streams if bank in each.banks] for bank in banks}


def shared_banks(memory_map: MemoryMap) -> Iterator[Finding]:
    """Find banks in which several masters stream, which happens at the same time, whatever the firmware does."""
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


def own_banks(memory_map: MemoryMap) -> Iterator[Finding]:
    """Find banks with two buffers of one master: the main loop decides whether both stream at the same time."""
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
        f"{listed([each.buffer for each in group])} of {master}"
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
