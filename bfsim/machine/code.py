"""The code of a firmware: which kernels each core runs, and how many bytes the linker must place for them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from bfsim.chip.memory_map import Region
from bfsim.kernel.build import Build
from bfsim.linker import LinkMap, Placement, Symbol
from bfsim.machine.memories import Memories
from bfsim.machine.named_kernels import kernels_named
from bfsim.machine.program import Main
from bfsim.process.once import once
from bfsim.trace import CodeRecord

SECTION = "program"  # input section of code, as VisualDSP++ names it
ALIGN_BYTES = 4


@once
def code_symbols(main: Main, processor: str | None, build: Build) -> Sequence[Symbol]:
    """Return one symbol for every kernel of a core's main loop, including callees.

    Library routines (division, floats) and the main loop itself are not counted.
    """
    nbytes: dict[str, int] = {}
    for kernel in kernels_named(main):
        nbytes.update(build.code_bytes(kernel))
    return tuple(
        Symbol(name, SECTION, size, ALIGN_BYTES, processor, object_file(name))
        for name, size in nbytes.items()
        if size
    )


def object_file(name: str) -> str:
    """Return the object file of a kernel or a buffer: each has its own, so that an LDF can place it separately."""
    stem = re.sub(r"\W", "_", name, flags=re.ASCII)
    return f"{stem}.doj"


def code_records(
    link_map: LinkMap, processors: Mapping[str, str | None], regions: Sequence[Region]
) -> tuple[CodeRecord, ...]:
    """Return where the code of each core went. `processors` are the names of the cores in the LDF."""
    free = {segment.name: segment.free_bytes for segment in link_map.segments}
    found: dict[tuple[str, str], list[Placement]] = {}
    for core, processor in processors.items():
        for placed in link_map.placements:
            if (
                placed.symbol.section == SECTION
                and processor is not None
                and placed.symbol.processor == processor
            ):
                found.setdefault((core, placed.segment), []).append(placed)
    return tuple(
        CodeRecord(
            core=core,
            segment=segment,
            in_l1=all(_in_l1(each, regions) for each in placements),
            kernels=len(placements),
            nbytes=sum(each.symbol.nbytes for each in placements),
            free_bytes=free[segment],
        )
        for (core, segment), placements in found.items()
    )


def code_outside_l1(
    link_map: LinkMap, processor: str | None, regions: Sequence[Region], memories: Memories
) -> dict[str, tuple[int, int]]:
    """Return (offset in the arena, bytes) of every routine of a processor in L2 or SDRAM, by symbol."""
    return {
        placed.symbol.name: (memories.offset_of(placed.address, placed.symbol.nbytes), placed.symbol.nbytes)
        for placed in link_map.placements
        if placed.symbol.section == SECTION
        and placed.symbol.processor == processor
        and not _in_l1(placed, regions)
    }


def _in_l1(placed: Placement, regions: Sequence[Region]) -> bool:
    holding = (each for each in regions if each.holds(placed.address, placed.symbol.nbytes))
    return any(each.memory.startswith("L1_CODE") for each in holding)
