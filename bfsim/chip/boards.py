"""Boards by name. 600 MHz and 133 MHz are two ratings that cannot run together on a 25 MHz crystal: see `ssel`."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from bfsim.chip.bf533 import BF533
from bfsim.chip.bf561 import BF561
from bfsim.chip.memory_map import with_sdram
from bfsim.chip.sdram_parts import BF561_EZKIT_64_MB, CM_BF533_32_MB, CM_BF561_32_MB, CM_BF561_64_MB
from bfsim.chip.sensors import LEFT_CAMERA, MHZ, OV9650, RIGHT_CAMERA
from bfsim.chip.spec import BoardSpec, ChipSpec, Pll, SdramSpec
from bfsim.clocks import Clocks
from bfsim.errors import ConfigError, shown
from bfsim.fields import require_types

CM_CLKIN_HZ = Fraction(25 * MHZ)  # CONFIG_CLKIN_HZ of u-boot's cm-bf561.h and cm-bf533.h
EZKIT_CLKIN_HZ = Fraction(30 * MHZ)  # CONFIG_CLKIN_HZ of u-boot's bf561-ezkit.h


def new_board(
    name: str,
    title: str,
    chip: ChipSpec,
    pll: Pll,
    sdram: SdramSpec,
    *,
    dma_over_core: bool,
    deb_period_transfers: int = 0,
) -> BoardSpec:
    """Return a board: the SDRAM in the chip's memory map, a camera on every PPI, and the clocks that the PLL makes."""
    require_types(pll, "pll")
    return BoardSpec(
        name=name,
        title=title,
        chip=replace(chip, regions=with_sdram(chip.regions, sdram.nbytes)),
        pll=pll,
        clocks=chip.clocks_of(pll),
        sdram=sdram,
        sensor=OV9650,
        cameras=(LEFT_CAMERA, RIGHT_CAMERA)[: chip.ppis],
        dma_over_core=dma_over_core,
        deb_period_transfers=deb_period_transfers,
        spi_clk_hz=Fraction(10 * MHZ),  # [assumed] practical range 10..20 MHz; the chip's limit is SCLK/4
    )


CM_BF561 = new_board(
    "cm-bf561",
    "Bluetechnix CM-BF561",
    BF561,
    # [assumed] setting of the thesis: the core at its rating, and ssel the smallest that keeps SCLK within its own
    Pll(clkin_hz=CM_CLKIN_HZ, vco_multiplier=24, csel=1, ssel=5),
    CM_BF561_32_MB,
    dma_over_core=True,  # u-boot's cm-bf561.h and Linux CM-BF561_defconfig: CDPRIO in EBIU_AMGCTL
)

CM_BF561_RATINGS = replace(
    CM_BF561,
    name="cm-bf561-ratings",
    title="CM-BF561, ratings that no PLL can pair",
    pll=None,
    # thesis, Table 1.1
    clocks=Clocks(cclk_hz=BF561.max_vco_hz, sclk_hz=BF561.max_sclk_hz),
)

CM_BF561_525_131 = new_board(
    "cm-bf561-525-131",
    "CM-BF561, SCLK nearest to its rating",
    BF561,
    Pll(
        clkin_hz=CM_CLKIN_HZ, vco_multiplier=21, csel=1, ssel=4
    ),  # 131.25 MHz; a multiplier of 22 makes 137.5
    CM_BF561_32_MB,
    dma_over_core=True,  # as cm-bf561
)

CM_BF561_500_125 = new_board(
    "cm-bf561-500-125",
    "CM-BF561 as Linux set it up in 2006",
    BF561,
    Pll(clkin_hz=CM_CLKIN_HZ, vco_multiplier=20, csel=1, ssel=4),  # Linux commit 407d3cce1a
    CM_BF561_32_MB,
    dma_over_core=True,  # Linux CM-BF561_defconfig: C_CDPRIO
    deb_period_transfers=1,  # Linux writes 0x0111 to DMA_TC_PER
)

CM_BF561_550_110 = new_board(
    "cm-bf561-550-110",
    "CM-BF561, 64 MB, u-boot of 2008",
    BF561,
    Pll(clkin_hz=CM_CLKIN_HZ, vco_multiplier=22, csel=1, ssel=5),  # u-boot's cm-bf561.h, 2008-10
    CM_BF561_64_MB,
    dma_over_core=True,  # the same: CDPRIO in EBIU_AMGCTL
)

CM_BF561_500_100 = new_board(
    "cm-bf561-500-100",
    "CM-BF561, 64 MB, later u-boot",
    BF561,
    Pll(clkin_hz=CM_CLKIN_HZ, vco_multiplier=20, csel=1, ssel=5),  # u-boot's cm-bf561.h, later
    CM_BF561_64_MB,
    dma_over_core=True,  # the same: CDPRIO in EBIU_AMGCTL
)

BF561_EZKIT = new_board(
    "bf561-ezkit",
    "ADSP-BF561 EZ-KIT Lite",  # [assumed] with two cameras in place of its video decoder and encoder
    BF561,
    Pll(clkin_hz=EZKIT_CLKIN_HZ, vco_multiplier=20, csel=1, ssel=5),  # u-boot's bf561-ezkit.h
    BF561_EZKIT_64_MB,
    dma_over_core=False,  # the same: EBIU_AMGCTL 0x3F has no CDPRIO
    deb_period_transfers=7,  # DMA1_TC_PER 0x0770 of the project that sdram_parts.py names
)

CM_BF533 = new_board(
    "cm-bf533",
    "Bluetechnix CM-BF533, one core, u-boot",
    BF533,
    Pll(clkin_hz=CM_CLKIN_HZ, vco_multiplier=22, csel=1, ssel=5),  # u-boot's cm-bf533.h
    CM_BF533_32_MB,
    dma_over_core=False,  # the same: EBIU_AMGCTL without CDPRIO
)

BOARDS = {
    each.name: each
    for each in (
        CM_BF561,
        CM_BF561_RATINGS,
        CM_BF561_525_131,
        CM_BF561_500_125,
        CM_BF561_550_110,
        CM_BF561_500_100,
        BF561_EZKIT,
        CM_BF533,
    )
}


def board_named(name: str) -> BoardSpec:
    """Return the board called `name`; raise ConfigError with the known ones otherwise."""
    try:
        return BOARDS[name]
    except KeyError:
        raise ConfigError(f"--board must be one of {', '.join(BOARDS)}, not {shown(name)}") from None
