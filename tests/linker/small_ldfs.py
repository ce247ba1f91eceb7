"""Small LDFs, symbols to place by them, and where these went, for the tests of the linker."""

from __future__ import annotations

from collections.abc import Callable

from bfsim.linker import LinkerScript, LinkMap, Symbol

Parse = Callable[[str], LinkerScript]
"""Parses the text of an LDF: a fixture of `conftest.py`."""

L1_A, L1_B, L2, SDRAM = 0xFF800000, 0xFF400000, 0xFEB00000, 0x1000

TWO_CORES = """$OBJECTS = $COMMAND_LINE_OBJECTS;
MEMORY {
   MEM_L2    { TYPE(RAM) START(0xFEB00000) LENGTH(1K) WIDTH(8) }
   MEM_SDRAM { TYPE(RAM) START(0x00001000) LENGTH(1M) WIDTH(8) }
}
COMMON_MEMORY {
   MASTERS(p0, p1)
   SECTIONS { shared { INPUT_SECTIONS($OBJECTS(l2_shared)) } > MEM_L2 }
}
PROCESSOR p0 {
   MEMORY { MEM_A { TYPE(RAM) START(0xFF800000) LENGTH(256) WIDTH(8) } }
   SECTIONS {
      a_fast { INPUT_SECTIONS($OBJECTS(fast)) INPUT_SECTIONS($OBJECTS(data1)) } > MEM_A
      a_l2   { INPUT_SECTIONS($OBJECTS(data1)) } > MEM_L2
      a_sdram { INPUT_SECTION_ALIGN(32) INPUT_SECTIONS($OBJECTS(data1)) } > MEM_SDRAM
   }
}
PROCESSOR p1 {
   MEMORY { MEM_B { TYPE(RAM) START(0xFF400000) LENGTH(256) WIDTH(8) } }
   SECTIONS {
      b_fast { INPUT_SECTIONS($OBJECTS(fast data1)) } > MEM_B
      b_l2   { INPUT_SECTIONS($OBJECTS(data1)) } > MEM_L2
   }
}
"""


def addresses(link_map: LinkMap) -> dict[str, int]:
    """Return the address of each symbol by its name."""
    return {placed.symbol.name: placed.address for placed in link_map.placements}


def used(link_map: LinkMap) -> dict[str, int]:
    """Return the bytes used in each segment by its name."""
    return {segment.name: segment.used_bytes for segment in link_map.segments}


def symbol(name: str, section: str, nbytes: int, processor: str | None = "p0", align: int = 4) -> Symbol:
    """Make a symbol, of core A unless said otherwise."""
    return Symbol(name, section, nbytes, align=align, processor=processor)


def one_section(statements: str, segment: str = "START(0xFF800000) LENGTH(256)", commands: str = "") -> str:
    """Write an LDF of one output section `data`."""
    return (
        f"PROCESSOR p0 {{ MEMORY {{ M {{ TYPE(RAM) {segment} WIDTH(8) }} }} {commands}\n"
        f"SECTIONS {{ data {{ {statements} }} > M }} }}"
    )
