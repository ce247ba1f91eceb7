"""LDFs of other chips, of one core and of several, as people write them: what they need to parse and to link."""

from __future__ import annotations

import pytest

from bfsim.chip.memory_map import KIB, Region
from bfsim.errors import LinkError
from bfsim.linker import Symbol, link
from tests.linker.small_ldfs import Parse

# BF533: 64 KB of code SRAM with the 16 KB that can be cache behind it, without a gap.
SINGLE_CORE = (
    Region("L1_CODE", "A", 0xFFA00000, 64 * KIB),
    Region("L1_CODE_CACHE", "A", 0xFFA10000, 16 * KIB),
    Region("L1_DATA_A", "A", 0xFF800000, 32 * KIB),
)

# What the LDFs of VisualDSP++ 4.5, 5.0 and of those who wrote their own have beside the plain statements.
HAND_WRITTEN = """
ARCHITECTURE(ADSP-BF533)
SEARCH_DIR( $ADI_DSP\\Blackfin\\lib; C:\\Program Files (x86)\\lib )
$LIBRARIES = ;
$OBJECTS = , "crt dir\\crts.doj" $COMMAND_LINE_OBJECTS,
#if defined(USE_CRTN)
   crtn532.doj,
#endif
   $COMMAND_LINE_OUTPUT_DIRECTORY/extra.doj ;
$ONE = libdsp.dlb[ fft.doj, "fir filter.doj" ];
MEMORY
{
   MEM_SYS_MMRS { START(0xFFC00000) END(0xFFDFFFFF) TYPE(RAM) WIDTH(8) }
   MEM_CODE {
      TYPE(RAM) WIDTH(8)
      START(0xFFA00000) END(0xFFA13FFF)   // SRAM and cache
   }
   MEM_DATA { TYPE(DM RAM) START(0xFF800000) END(0xFF807FFF) WIDTH(8) };
}
PROCESSOR core0
{
   OUTPUT( $COMMAND_LINE_OUTPUT_FILE )
   ENTRY(start);
   RESOLVE(start,0xFFA00000)
   RESOLVE("_shared data", shared.sm)
   RESOLVE(_other, "other.dxe")
   RESOLVE_LOCALLY(TRUE)
   KEEP(start,_main) KEEP_SECTIONS(data1) ELIMINATE_SECTIONS(program, data1)
   $LOCAL = $OBJECTS, $ONE;
   SECTIONS
   {
      #define DEF_SECTION_QUAL /* none */
      boot DEF_SECTION_QUAL
      {
         FILL(0)
         INPUT_SECTIONS_PIN( $LOCAL(boot*) )
         EXECUTABLE_NAME(__executable_name)
      } >MEM_CODE//all of it
      .meminit { ALIGN(4) } >MEM_CODE
      code SHT_PROGBITS NO_INIT { INPUT_SECTIONS( $OBJECTS(program "my code" L1_?), $LIBRARIES(program)) } > MEM_CODE
      .debug SHT_DEBUGINFO { INPUT_SECTIONS($OBJECTS(.debug_info)) }
      stack { ldf_stack_space = .; ldf_stack_end = ldf_stack_space + MEMORY_SIZEOF(MEM_DATA); } > MEM_DATA
   }
}
"""


def core0(name: str, section: str, object_file: str = "firmware.doj") -> Symbol:
    """Make a symbol of the only core."""
    return Symbol(name, section, 16, processor="core0", object_file=object_file)


def test_a_hand_written_ldf_links(parse: Parse) -> None:
    """Wildcards, quoted names, members of libraries, sections without memory and commands without effect."""
    symbols = [
        core0("a", "program"),
        core0("b", "my code"),
        core0("c", "L1_x"),
        core0("d", "boot_kernel", "fft.doj"),
        core0("e", "boot2", "fir filter.doj"),
    ]
    linked = link(parse(HAND_WRITTEN), symbols, SINGLE_CORE, chip="ADSP-BF533")
    assert [p.symbol.name for p in linked.placements] == ["d", "e", "a", "b", "c"]
    assert linked.values["core0", "ldf_stack_end"] == 0xFF808000
    with pytest.raises(LinkError, match=r"section of symbol 'x' of core0"):
        link(parse(HAND_WRITTEN), [core0("x", "boot", "iir.dlb")], SINGLE_CORE, chip="ADSP-BF533")


@pytest.mark.parametrize(
    "chip",
    [
        "BF531",
        "BF532",
        "BF533",
        "BF534",
        "BF536",
        "BF537",
        "BF538",
        "BF539",
        "BF561",
        "BF527",
        "BF548",
        "BF707",
    ],
)
def test_every_blackfin_is_read(parse: Parse, chip: str) -> None:
    """The chip is the script's, and the board's chip must be the same."""
    script = parse(f"ARCHITECTURE(ADSP-{chip}) PROCESSOR p0 {{ }}")
    assert script.chip == f"ADSP-{chip}"
    assert link(script, [], chip=f"ADSP-{chip}").placements == ()
    with pytest.raises(
        LinkError,
        match=rf"ARCHITECTURE must be ADSP-BF999, the board's chip, not ADSP-{chip}; --board takes another .* and `bfsim ldf` shows",
    ):
        link(script, [], chip="ADSP-BF999")


def test_processors_are_cores(parse: Parse) -> None:
    """On the BF561 by name; on a single core the only PROCESSOR is core A, whatever its name."""
    assert parse("ARCHITECTURE(ADSP-BF561)").core_of_processor == {"p0": "A", "p1": "B"}
    assert parse("ARCHITECTURE(ADSP-BF537) PROCESSOR main { }").core_of_processor == {"main": "A"}
    anywhere = parse("PROCESSOR main { }")
    assert link(anywhere, [], chip="ADSP-BF537").placements == ()
    two = parse("ARCHITECTURE(ADSP-BF537) PROCESSOR p0 { } PROCESSOR p1 { }")
    with pytest.raises(
        LinkError, match=r"ADSP-BF537 has one core, and the LDF must have one PROCESSOR, not 2"
    ):
        link(two, [], chip="ADSP-BF537")
    with pytest.raises(LinkError, match=r"test\.ldf:1: processor must be p0 or p1 on an ADSP-BF561, not p2"):
        link(parse("PROCESSOR p2 { }"), [])
    with pytest.raises(LinkError, match=r"processor must be p0 or p1 on an ADSP-BF561, not p7"):
        link(parse("COMMON_MEMORY { MASTERS(p0 p7) }"), [])


def test_memories_behind_each_other_are_one(parse: Parse) -> None:
    """A segment may run over SRAM into the part that can be cache, but not beyond."""
    text = "PROCESSOR p0 {{ MEMORY {{ M {{ START(0xFFA00000) LENGTH({}) }} }} SECTIONS {{ a {{ }} > M }} }}"
    assert link(parse(text.format("80K")), [], SINGLE_CORE).segments[0].nbytes == 80 * KIB
    with pytest.raises(LinkError, match=r"segment 'M': .* must lie inside one memory"):
        link(parse(text.format("81K")), [], SINGLE_CORE)


TWO_VIEWS = """
PROCESSOR p0 {
   MEMORY { L2 { START(0xFEB00000) LENGTH(1K) } L1 { START(0xFF800000) LENGTH(1K) } }
   SECTIONS { RESERVE(boot = 0xFEB00000, n = 16) a { INPUT_SECTIONS(x.doj(data1)) l1 = MEMORY_START(L1); } > L2 }
}
PROCESSOR p1 {
   MEMORY { L2 { START(0xFEB00000) LENGTH(1K) } L1 { START(0xFF400000) LENGTH(1K) } }
   SECTIONS { RESERVE(boot = 0xFEB00000, n = 16) b { INPUT_SECTIONS(x.doj(data1)) l1 = MEMORY_START(L1); } > L2 }
}
"""


def test_processors_have_their_own_view_of_a_memory(parse: Parse) -> None:
    """Segments of one name are each processor's own; those for the same memory fill from one pointer."""
    symbols = [Symbol("x", "data1", 100, processor=p, object_file="x.doj") for p in ("p1", "p0")]
    linked = link(parse(TWO_VIEWS), symbols)
    assert linked.find("p0", "x").address == 0xFEB00010
    assert linked.find("p1", "x").address == 0xFEB00010 + 100
    assert {usage.name: usage.used_bytes for usage in linked.segments} == {
        "L2": 216,
        "L1": 0,
        "p1.L2": 216,
        "p1.L1": 0,
    }
    assert (linked.values["p0", "l1"], linked.values["p1", "l1"]) == (0xFF800000, 0xFF400000)
    other = TWO_VIEWS[::-1].replace("K1(HTGNEL", "K2(HTGNEL", 2)[::-1]
    with pytest.raises(
        LinkError, match=r"test\.ldf:7: segment 'p1\.L2' of p1 must be the same memory as 'L2' of p0"
    ):
        link(parse(other), symbols)
