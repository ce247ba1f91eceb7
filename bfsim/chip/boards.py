"""Boards by name. 600 MHz and 133 MHz are two ratings that cannot run together on a 25 MHz crystal: see `sclk`."""

from __future__ import annotations

from fractions import Fraction

from bfsim.chip.bf561 import BF561
from bfsim.chip.sdram_parts import MT48LC8M32B2
from bfsim.chip.sensors import MHZ, OV9650
from bfsim.chip.spec import BoardSpec
from bfsim.clocks import Clocks
from bfsim.errors import ConfigError

CM_BF561 = BoardSpec(
    name="cm-bf561",
    title="Bluetechnix CM-BF561, 600/120 MHz",
    chip=BF561,
    # 25 MHz CLKIN x 24 = 600 MHz VCO; SSEL 5 is the smallest that keeps SCLK within its 133 MHz rating
    clocks=Clocks(cclk_hz=Fraction(600 * MHZ), sclk_hz=Fraction(120 * MHZ)),
    sdram=MT48LC8M32B2,
    sensor=OV9650,
    dma_over_core=True,  # u-boot cm-bf561.h: EBIU_AMGCTL with CDPRIO
    spi_clk_hz=Fraction(10 * MHZ),  # [assumed] practical range 10..20 MHz; the chip's limit is SCLK/4
)

CM_BF561_RATINGS = BoardSpec(
    name="cm-bf561-ratings",
    title="CM-BF561 at both ratings of thesis Table 1.1, 600/133\u2153 MHz (no PLL setting gives this pair)",
    chip=BF561,
    clocks=Clocks(cclk_hz=Fraction(600 * MHZ), sclk_hz=Fraction(400 * MHZ, 3)),
    sdram=MT48LC8M32B2,
    sensor=OV9650,
    dma_over_core=True,  # u-boot cm-bf561.h: EBIU_AMGCTL with CDPRIO
    spi_clk_hz=Fraction(10 * MHZ),  # [assumed] practical range 10..20 MHz; the chip's limit is SCLK/4
)

BOARDS = {each.name: each for each in (CM_BF561, CM_BF561_RATINGS)}


def board_named(name: str) -> BoardSpec:
    """Return the board called `name`; raise ConfigError with the known ones otherwise."""
    try:
        return BOARDS[name]
    except KeyError:
        raise ConfigError(f"--board must be one of {', '.join(BOARDS)}, not {name!r}") from None
