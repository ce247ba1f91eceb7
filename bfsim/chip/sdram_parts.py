"""The SDRAM of each board: parts, and the register words with which the boot code sets its controller up."""

from __future__ import annotations

from bfsim.chip.ebiu_registers import sdram_geometry_of, sdram_timing_of
from bfsim.chip.spec import SdramSpec

TURN_ROUND_SCLK = 1  # [assumed] the data bus rests a cycle between a read and a write
REFRESH_MS = 64  # Linux arch/blackfin/include/asm/mem_init.h, SDRAM_Tref of every part

# SCTLE | PSS | TWR_2 | TRCD_2 | TRP_2 | TRAS_7 | CL_3: u-boot's cm-bf561.h and cm-bf533.h, at 100 and 110 MHz;
# Linux mem_init.h sets the same fields above 119.4 MHz, so also at 120, 125, 131.25 and 133 1/3 MHz
SDGCTL_OF_CM_BF5XX = 0x0091_11CD

CM_BF561_32_MB = SdramSpec(
    part="Micron MT48LC8M32B2B5-7",  # Linux CM-BF561_defconfig, 2008-02..04
    **sdram_timing_of(SDGCTL_OF_CM_BF5XX),
    turn_round_sclk=TURN_ROUND_SCLK,
    refresh_ms=REFRESH_MS,
    rows_refreshed=4096,  # Linux mem_init.h, SDRAM_NRA of this part
    # the same defconfig: MEM_SIZE 32, MEM_ADD_WIDTH 9; 32 bits by the part's name
    **sdram_geometry_of(sdbctl=0x13, word_bytes=4),
)

CM_BF561_64_MB = SdramSpec(
    part="64 MB on 32 bits",  # of a later module; no source names it
    **sdram_timing_of(SDGCTL_OF_CM_BF5XX),
    turn_round_sclk=TURN_ROUND_SCLK,
    refresh_ms=REFRESH_MS,
    rows_refreshed=4096,  # u-boot's cm-bf561.h divides by 4096, though these sizes make 8192 rows
    **sdram_geometry_of(sdbctl=0x15, word_bytes=4),  # u-boot's cm-bf561.h: MEM_SIZE 64, MEM_ADD_WDTH 9
)

BF561_EZKIT_64_MB = SdramSpec(
    part="2 x Micron MT48LC16M16A2TG-75",  # u-boot's bf561-ezkit.h; two, for 32 bits and 64 MB
    # EBIU_SDGCTL 0x0091998F and EBIU_SDBCTL 0x15: Init_SDRAM.c of a VisualDSP++ project for this board,
    # GitHub Dentaku1992/DigitalSignalProcessingOnABlackFin
    **sdram_timing_of(0x0091_998F),
    turn_round_sclk=TURN_ROUND_SCLK,
    refresh_ms=REFRESH_MS,
    # Linux mem_init.h, SDRAM_NRA of this part; the project's EBIU_SDRRC, 0x3A9, is 120 MHz x 64 ms / 8192, too
    rows_refreshed=8192,
    **sdram_geometry_of(sdbctl=0x15, word_bytes=4),
)

CM_BF533_32_MB = SdramSpec(
    part="Micron MT48LC16M16A2TG-75",  # Linux CM-BF533_defconfig
    **sdram_timing_of(SDGCTL_OF_CM_BF5XX),
    turn_round_sclk=TURN_ROUND_SCLK,
    refresh_ms=REFRESH_MS,
    rows_refreshed=8192,  # u-boot's cm-bf533.h; Linux mem_init.h, SDRAM_NRA of this part
    **sdram_geometry_of(sdbctl=0x13, word_bytes=2),  # u-boot's cm-bf533.h: MEM_SIZE 32, MEM_ADD_WDTH 9
)
