"""Memory that the LDF of VisualDSP++ turns into cache."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from bfsim.chip.memory_map import KIB, Region
from bfsim.linker import LinkerScript
from bfsim.report.ldf.map import CacheRange

CACHE_SWITCHES = {
    "___l1_data_cache_a": "L1_DATA_A",
    "___l1_data_cache_b": "L1_DATA_B",
    "___l1_code_cache": "L1_CODE_CACHE",
}
"""Symbols by which an LDF of VisualDSP++ turns the upper half of an L1 memory into cache, unless they are 0."""

CACHE_BYTES = 16 * KIB
"""The size of a cache at the end of its memory: the same on ADSP-BF561 and ADSP-BF533."""


def caches_of(script: LinkerScript, regions: Sequence[Region]) -> Iterator[CacheRange]:
    """Yield the memory that the LDF's switches turn into cache, core by core."""
    for block in script.blocks:
        for name, memory in CACHE_SWITCHES.items():
            if not block.assignments.get(name):
                continue
            for region in regions:
                cores = {script.core_of_processor.get(each) for each in block.processors}
                if region.memory == memory and region.owner in cores:
                    yield CacheRange(
                        memory=region.name,
                        owner=region.owner,
                        start=region.start + region.nbytes - CACHE_BYTES,
                        nbytes=CACHE_BYTES,
                    )
