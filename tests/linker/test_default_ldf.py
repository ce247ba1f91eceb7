"""An LDF with the constructs that the VisualDSP++ 5.0 wizard writes for two cores and 64 MB of SDRAM."""

from __future__ import annotations

from collections.abc import Callable

from bfsim.chip.memory_map import bf561_regions
from bfsim.linker import LinkerScript, Symbol, link

WIZARD = r"""
/* MANAGED-BY-SYSTEM-BUILDER */
ARCHITECTURE(ADSP-BF561)
SEARCH_DIR($ADI_DSP/Blackfin/lib)
#define RT_LIB_NAME(x) lib ## x ## y.dlb
#define RT_OBJ_NAME(x) x ## y.doj
#define LIBS \
   RT_LIB_NAME(c561) \
   ,RT_LIB_NAME(dsp561) \

$LIBS = LIBS;
$LIBRARIES_CORE_A =
/*$VDSG<insert-user-libraries-coreA-beginning> */
   corea.dlb
   ,$LIBS {(!DualCoreMem("CoreB")) && (!sharing("MustShare"))}
   ;
$LIBRARIES_SML3 = sml3.dlb, $LIBS;
$LIBRARIES_SML3_CM =
   $LIBRARIES_SML3
   ;
$OBJECTS_CORE_A = "basiccrt.doj", $COMMAND_LINE_OBJECTS {!DualCoreMem("CoreB")}, RT_OBJ_NAME(crtn561);
$OBJS_LIBS_INTERNAL_CORE_A = $OBJECTS_CORE_A{prefersMem("internal")},
   $LIBRARIES_CORE_A{prefersMem("internal")};
$OBJECTS = $COMMAND_LINE_OBJECTS;
#define ASYNC0_MEMTYPE RAM
MEMORY
{
   MEM_L2_SRAM             { TYPE(RAM) START(0xFEB00000) END(0xFEB1FFFF) WIDTH(8) }
   MEM_ASYNC0              { TYPE(ASYNC0_MEMTYPE) START(0x20000000) END(0x23FFFFFF) WIDTH(8) }
   MEM_SDRAM_BANK0         { TYPE(RAM) START(0x00000004) END(0x00ffffff) WIDTH(8) }
} /* MEMORY */
COMMON_MEMORY
{
   OUTPUT($COMMAND_LINE_OUTPUT_DIRECTORY/L2_and_L3_common_memory.sm)
   MASTERS(p0, p1)
   SECTIONS
   {
      frame_buffer0 NO_INIT {
          INPUT_SECTION_ALIGN(2)
          INPUT_SECTIONS( $LIBRARIES_SML3_CM(frame_buffer0))
      } > MEM_SDRAM_BANK0
      L2_eh_rtti
      {
         INPUT_SECTION_ALIGN(4)
         FORCE_CONTIGUITY
         INPUT_SECTIONS($LIBS{sharing("MustShare")}(data1)  $LIBRARIES_SML3_CM(.frt))
      } > MEM_L2_SRAM
   }
}
PROCESSOR p0
{
   MEMORY
   {
      MEM_A_L1_CODE           { TYPE(RAM) START(0xFFA00000) END(0xFFA03FFF) WIDTH(8) }
      MEM_A_L1_DATA_A         { TYPE(RAM) START(0xFF800000) END(0xFF807FFF) WIDTH(8) }
   }
   OUTPUT($COMMAND_LINE_OUTPUT_DIRECTORY/p0.dxe)
   RESOLVE(start, 0xFFA00000)
   KEEP(start,_main)
   SECTIONS
   {
      RESERVE(___ssld=0xFEB1FC00, ___lssld = 0x400)
      RESERVE(___waba3=MEMORY_END(MEM_A_L1_CODE) - 75, ___la3 = 76)
      RESERVE(___waba7=MEMORY_END(MEM_A_L1_DATA_A) - 75, ___la7 = 76)
      L1_code
      {
         INPUT_SECTION_ALIGN(4)
         __CORE = 0;
         INPUT_SECTIONS($OBJS_LIBS_INTERNAL_CORE_A(program))
         INPUT_SECTIONS($OBJECTS_CORE_A(program) $LIBRARIES_CORE_A(program))
      } > MEM_A_L1_CODE
      L1_data_a_1
      {
         INPUT_SECTION_ALIGN(4)
         ___l1_data_cache_a = 0;
         INPUT_SECTIONS($OBJECTS_CORE_A(L1_data_a) $LIBRARIES_CORE_A(L1_data_a))
         RESERVE(heaps_and_stack_in_L1_data_a, heaps_and_stack_in_L1_data_a_length = 2048,4)
      } > MEM_A_L1_DATA_A
      L1_data_a
      {
         INPUT_SECTIONS($OBJECTS_CORE_A(data1) $LIBRARIES_CORE_A(data1))
      } > MEM_A_L1_DATA_A
      L1_data_a_stack_heap
      {
         RESERVE_EXPAND(heaps_and_stack_in_L1_data_a, heaps_and_stack_in_L1_data_a_length , 0, 4)
         ldf_heap_space = heaps_and_stack_in_L1_data_a;
         ldf_heap_end = (ldf_heap_space + (heaps_and_stack_in_L1_data_a_length - 4)) & 0xfffffffc;
      } > MEM_A_L1_DATA_A
   }
}
"""


def test_a_wizard_ldf_links(parse: Callable[[str], LinkerScript]) -> None:
    """Objects and libraries of such a file land where its lists, predicates, reserves and order put them."""
    symbols = [
        Symbol("start", "program", 64, processor="p0", object_file="basiccrt.doj"),
        Symbol("_main", "program", 200, processor="p0"),
        Symbol("ring", "L1_data_a", 1000, processor="p0"),
        Symbol("table", "data1", 100, processor="p0", object_file="corea.dlb"),
        Symbol("sqrt_table", "data1", 100, processor="p0", object_file="libdsp561y.dlb"),
        Symbol("frame", "frame_buffer0", 614400, object_file="sml3.dlb"),
    ]
    placed = link(parse(WIZARD), symbols, bf561_regions(64 << 20))
    assert {p.symbol.name: p.address for p in placed.placements} == {
        "frame": 0x4,
        "start": 0xFFA00000,
        "_main": 0xFFA00040,
        "ring": 0xFF800000,
        "table": 0xFF800000 + 1000 + 2048,
        "sqrt_table": 0xFF800000 + 1000 + 2048 + 100,
    }
    used = {segment.name: segment.used_bytes for segment in placed.segments}
    assert used["MEM_A_L1_DATA_A"] == 1000 + 2048 + 200 + 76
    assert used["MEM_L2_SRAM"] == 1024
