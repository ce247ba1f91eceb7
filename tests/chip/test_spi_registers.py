"""The rate of the SPI."""

from __future__ import annotations

from fractions import Fraction

import pytest

from bfsim.chip.spi_registers import SpiRate
from bfsim.errors import ConfigError

MHZ = 1_000_000


@pytest.mark.parametrize(
    ("baud", "sck_hz"), [(2, 30 * MHZ), (3, 20 * MHZ), (6, 10 * MHZ), (0xFFFF, Fraction(120 * MHZ, 131070))]
)
def test_rate(baud: int, sck_hz: Fraction) -> None:
    """SCLK / (2 * BAUD) at 120 MHz."""
    assert SpiRate(baud=baud).sck_hz(Fraction(120 * MHZ)) == sck_hz


@pytest.mark.parametrize("baud", [-1, 0, 1, 0x10000])
def test_rates_that_do_not_exist(baud: int) -> None:
    """BAUD 1 would be SCLK / 2, which is too fast; 0 stops the clock."""
    with pytest.raises(ConfigError, match=f"SPI_BAUD must be 2..65535, not {baud}"):
        SpiRate(baud=baud)


def test_gap_is_no_less_than_nothing() -> None:
    """Words cannot overlap."""
    with pytest.raises(ConfigError, match="must be 0 SCK cycles or more, not -1"):
        SpiRate(baud=2, gap_sck=Fraction(-1))
