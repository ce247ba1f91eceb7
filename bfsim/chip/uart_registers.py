"""Facts about the UART's registers: the rate that the divisor latch sets, and how many of them a transfer by DMA needs."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from bfsim.errors import ConfigError

SAMPLES = 16  # HRM of the BF533, UART: a bit takes 16 cycles of a clock of SCLK / divisor
DIVISOR_MOST = 0x10000  # the same: UART_DLH and UART_DLL have 16 bits, and 0 stands for 65536
FRAME_BITS = (
    10  # UART_LCR with WLS of 8 bits, no parity and one stop bit [ours]: what Linux bfin_5xx.c begins with
)
TRANSFER_WRITES = (
    5  # [ours] UART_IER (ETBEI or ERBFI), and START_ADDR, X_COUNT, X_MODIFY and CONFIG of the channel
)

# The stop bit is sampled in its middle, by a clock that finds the start bit to one sample: two ends may differ by so much.
MOST_DRIFT = (Fraction(1, 2) - Fraction(1, SAMPLES)) / (FRAME_BITS - Fraction(1, 2))


@dataclass(frozen=True, slots=True)
class UartRate:
    """The UART's rate: a bit takes 16 · `divisor` SCLK. Raises ConfigError for a divisor that does not fit the latch."""

    divisor: int

    def __post_init__(self) -> None:
        if not 1 <= self.divisor <= DIVISOR_MOST:
            raise ConfigError(f"the divisor of the UART must be 1..{DIVISOR_MOST}, not {self.divisor}")

    def baud(self, sclk_hz: Fraction) -> Fraction:
        """Return the rate in bits a second."""
        return sclk_hz / (SAMPLES * self.divisor)


def rate_for(baud: Fraction, sclk_hz: Fraction) -> UartRate:
    """Return the rate that is nearest to the other end's. Raises ConfigError if its bits would not be understood."""
    ideal = sclk_hz / (SAMPLES * baud) if baud > 0 else Fraction(0)
    divisor = min(max(1, round(ideal)), DIVISOR_MOST)
    nearest = UartRate(divisor).baud(sclk_hz)
    if abs(nearest - baud) > MOST_DRIFT * baud:
        raise ConfigError(
            f"a rate over the UART must be within {float(MOST_DRIFT):.1%} of SCLK / (16 * divisor), not {float(baud):,.1f} baud: "
            f"at SCLK {float(sclk_hz) / 1e6:g} MHz the nearest is {float(nearest):,.1f}, with divisor {divisor}"
        )
    return UartRate(divisor)
