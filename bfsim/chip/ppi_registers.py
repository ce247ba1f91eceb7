"""Facts about the PPI's registers: the bits of STATUS and the fastest clock."""

from __future__ import annotations

from enum import IntFlag
from fractions import Fraction

from bfsim.errors import ConfigError

PPI_CLK_SHARE = Fraction(1, 2)  # [assumed] of SCLK: the fastest PPI_CLK


class PpiStatusBit(IntFlag):
    """Bits of PPI_STATUS (defBF561.h). A read clears the register on the BF561 (Linux mach-bf561 cdefBF561.h)."""

    FLD = 0x0400
    FT_ERR = 0x0800
    OVR = 0x1000
    UNDR = 0x2000
    ERR_DET = 0x4000
    ERR_NCOR = 0x8000


def check_ppi_clk(ppi_clk_hz: Fraction, sclk_hz: Fraction) -> None:
    """Raise ConfigError if PPI_CLK is too fast for the PPI at this SCLK."""
    most_hz = sclk_hz * PPI_CLK_SHARE
    if ppi_clk_hz > most_hz:
        raise ConfigError(
            f"PPI_CLK must be at most SCLK * {PPI_CLK_SHARE} = {float(most_hz) / 1e6:g} MHz, "
            f"not {float(ppi_clk_hz) / 1e6:g} MHz"
        )
