"""The linker: an LDF in the language of VisualDSP++, and the addresses it gives the firmware's symbols."""

from __future__ import annotations

from bfsim.linker.link_map import LinkMap, PlacedReserve, Placement, SegmentUsage, Symbol
from bfsim.linker.parser import parse_ldf
from bfsim.linker.placement import link
from bfsim.linker.script import CORE_OF_PROCESSOR, LinkerScript

__all__ = [
    "CORE_OF_PROCESSOR",
    "LinkMap",
    "LinkerScript",
    "PlacedReserve",
    "Placement",
    "SegmentUsage",
    "Symbol",
    "link",
    "parse_ldf",
]
