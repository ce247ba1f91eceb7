"""The caches that an LDF switches on: what they hold, and what they take from L1.

VisualDSP++ enables them through symbols of the LDF; its start-up code does the rest. The data caches hold SDRAM, written back
as in its default protection table, or written through where the firmware's own table says so. The code cache holds all code
outside L1. There is no coherence.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from bfsim.chip.block_spec import CacheSpec
from bfsim.chip.memory_map import Region
from bfsim.errors import FirmwareError, LinkError
from bfsim.kernel.calls.access_log import MAX_REGIONS, Policy
from bfsim.kernel.calls.access_trace import CachedRegion, CacheSize
from bfsim.linker import LinkMap
from bfsim.machine.memories import Memories

DATA_SYMBOLS = {"___l1_data_cache_a": "L1_DATA_A", "___l1_data_cache_b": "L1_DATA_B"}
CODE_SYMBOL = "___l1_code_cache"


@dataclass(frozen=True, slots=True)
class Caches:
    """The caches of one core: the memories of L1 whose upper part is `data` cache, and whether code is cached."""

    data: tuple[str, ...]
    code: bool

    def data_size(self, spec: CacheSpec) -> CacheSize | None:
        """Return the size of the data cache, or None without one."""
        if not self.data:
            return None
        return CacheSize(spec.data_bytes_per_bank * len(self.data), spec.line_bytes, spec.data_ways)

    def regions(self, memories: Memories, write_through: Sequence[CachedRegion]) -> tuple[CachedRegion, ...]:
        """Return the regions that the data cache holds lines of: SDRAM, some of it written through."""
        return (*write_through, CachedRegion(0, memories.sdram_end, Policy.WRITE_BACK)) if self.data else ()


def caches_of(link_map: LinkMap, processor: str | None) -> Caches:
    """Return the caches that the LDF enables on a processor."""

    def is_on(symbol: str) -> bool:
        values = link_map.values
        return bool(values.get((processor, symbol), values.get((None, symbol), 0)))

    data = tuple(memory for symbol, memory in DATA_SYMBOLS.items() if is_on(symbol))
    return Caches(data, is_on(CODE_SYMBOL))


def written_through(names: Sequence[str], link_map: LinkMap, memories: Memories) -> tuple[CachedRegion, ...]:
    """Return the memory segments `names` of the LDF as write-through regions.

    Raises FirmwareError for a segment outside SDRAM, or for more segments than a core's protection table can hold.
    """
    segments = {each.name: each for each in link_map.segments if each.start < memories.sdram_end}
    if len(names) >= MAX_REGIONS:
        raise FirmwareError(f"write_through must name at most {MAX_REGIONS - 1} segments, not {len(names)}")
    for name in names:
        if name not in segments:
            raise FirmwareError(
                f"write_through must name segments of the LDF in SDRAM, {', '.join(segments)}, not {name!r}"
            )
    found = (segments[name] for name in names)
    return tuple(CachedRegion(each.start, each.start + each.nbytes, Policy.WRITE_THROUGH) for each in found)


def cached_parts(core: str, caches: Caches, regions: Sequence[Region]) -> Iterator[Region]:
    """Yield the parts of a core's L1 that are cache. No DMA reaches them, and nothing can be placed there."""
    for each in regions:
        is_cache = each.memory in caches.data or (caches.code and each.memory == "L1_CODE_CACHE")
        if each.owner == core and is_cache:
            yield replace(each, start=each.start + each.nbytes - each.cache_nbytes, nbytes=each.cache_nbytes)


def check_caches(link_map: LinkMap, core: str, caches: Caches, regions: Sequence[Region]) -> None:
    """Raise LinkError if something lies in the part of the core's L1 that is cache."""
    for part in cached_parts(core, caches, regions):
        for placed in link_map.placements:
            end = placed.address + placed.symbol.nbytes
            if placed.symbol.nbytes and placed.address < part.start + part.nbytes and end > part.start:
                raise LinkError(
                    f"{placed.symbol} (section {placed.symbol.section}) must lie outside of 0x{part.start:08X}-"
                    f"0x{part.start + part.nbytes - 1:08X} of {part.name}, which the LDF makes a cache, "
                    f"not at 0x{placed.address:08X}"
                )
