"""SDRAM parts, with the timing that the boards' boot code programs."""

from __future__ import annotations

from bfsim.chip.memory_map import KIB, MIB
from bfsim.chip.spec import SdramSpec

MT48LC8M32B2 = SdramSpec(
    part="Micron MT48LC8M32B2B5-7",  # Linux CM-BF561_defconfig, 2008-02..04
    # EBIU_SDGCTL of u-boot's cm-bf561.h: CL_3, TRCD_2, TRP_2, TRAS_7, TWR_2
    nCL=3,
    nRCD=2,
    nRP=2,
    nRAS=7,
    nWR=2,
    turn_round_sclk=1,  # [assumed] the data bus rests a cycle between a read and a write
    # 4096 rows in 64 ms: Linux mach-bf561 mem_init.h, NRA 4096 and tREF 64
    refresh_ms=64,
    rows_refreshed=4096,
    # 4 banks x 4096 rows x 512 columns x 32 bit (geometry derived from the part number and CONFIG ADD_WIDTH=9)
    word_bytes=4,
    page_bytes=2 * KIB,
    bank_bytes=8 * MIB,
    banks=4,
)
