"""The rate of the UART: what its divisor makes, and which rates two ends understand."""

from __future__ import annotations

from fractions import Fraction

import pytest

from bfsim.chip.uart_registers import UartRate, rate_for
from bfsim.errors import ConfigError

SCLK_HZ = Fraction(120_000_000)


@pytest.mark.parametrize(
    ("divisor", "baud"),
    [
        (1, 7_500_000),
        (65, Fraction(7_500_000, 65)),
        (781, Fraction(7_500_000, 781)),
        (65536, Fraction(7_500_000, 65536)),
    ],
)
def test_a_bit_takes_sixteen_cycles_for_each_of_the_divisor(divisor: int, baud: Fraction) -> None:
    """SCLK / (16 * divisor) at 120 MHz."""
    assert UartRate(divisor).baud(SCLK_HZ) == baud


@pytest.mark.parametrize("divisor", [-1, 0, 65537])
def test_divisors_that_the_latch_does_not_have(divisor: int) -> None:
    """It has 16 bits; what it makes of 0 is 65536."""
    with pytest.raises(ConfigError, match=f"the divisor of the UART must be 1..65536, not {divisor}"):
        UartRate(divisor)


@pytest.mark.parametrize(
    ("baud", "divisor"), [(9600, 781), (115_200, 65), (921_600, 8), (7_500_000, 1), (115, 65217)]
)
def test_the_nearest_divisor_is_taken(baud: int, divisor: int) -> None:
    """Of usual rates, the fastest and the slowest."""
    assert rate_for(Fraction(baud), SCLK_HZ) == UartRate(divisor)


def test_two_ends_may_be_apart_by_less_than_half_a_bit_at_the_stop_bit() -> None:
    """(1/2 - 1/16) of a bit in 9.5 bits: 4.6 %; at 7.5 Mbaud, where the divisor is 1, from both sides."""
    fastest, most = Fraction(7_500_000), Fraction(7, 152)
    slowest_ear, quickest_ear = fastest / (1 + most), fastest / (1 - most)
    for baud in (slowest_ear, quickest_ear):
        assert rate_for(baud, SCLK_HZ) == UartRate(1)
    for baud in (slowest_ear - 1, quickest_ear + 1):
        with pytest.raises(
            ConfigError,
            match=r"must be within 4.6% of SCLK / \(16 \* divisor\), not .* baud: at SCLK 120 MHz the nearest is 7,500,000.0, with divisor 1",
        ):
            rate_for(baud, SCLK_HZ)


@pytest.mark.parametrize("baud", [-9600, 0, 100, 10_000_000])
def test_rates_that_no_divisor_makes(baud: int) -> None:
    """None, too slow, and too fast."""
    with pytest.raises(ConfigError, match="a rate over the UART must be within"):
        rate_for(Fraction(baud), SCLK_HZ)
