"""The fastest clock of a PPI, from both sides."""

from __future__ import annotations

from fractions import Fraction

import pytest

from bfsim.chip.ppi_registers import check_ppi_clk
from bfsim.errors import ConfigError

MHZ = 1_000_000


def test_fastest_clock() -> None:
    """Half of SCLK is allowed, and not a Hertz more."""
    check_ppi_clk(Fraction(60 * MHZ), Fraction(120 * MHZ))
    with pytest.raises(ConfigError, match=r"PPI_CLK must be at most SCLK \* 1/2 = 50 MHz, not 54 MHz"):
        check_ppi_clk(Fraction(54 * MHZ), Fraction(100 * MHZ))
    with pytest.raises(ConfigError):
        check_ppi_clk(Fraction(60 * MHZ + 1), Fraction(120 * MHZ))
