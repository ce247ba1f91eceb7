"""Facts about the SPI's registers: the rate that BAUD sets, and how many of them a transfer by DMA needs."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from bfsim.errors import ConfigError

BAUD_LEAST = 2  # Linux bfin5xx_spi.h MIN_SPI_BAUD_VAL: at most SCLK / 4
BAUD_MOST = 0xFFFF  # SPI_BAUD has 16 bits
TRANSFER_WRITES = 5  # [ours] SPI_CTL, and START_ADDR, X_COUNT, X_MODIFY and CONFIG of the channel


@dataclass(frozen=True, slots=True, kw_only=True)
class SpiRate:
    """How fast a master clocks words: SCK = SCLK / (2 · `baud`), and `gap_sck` idle SCK cycles between two words.

    Raises ConfigError for a BAUD that the chip does not have.
    """

    baud: int
    gap_sck: Fraction = Fraction(1)  # [assumed] half a cycle to a whole one as long as DMA keeps TDBR full

    def __post_init__(self) -> None:
        if not BAUD_LEAST <= self.baud <= BAUD_MOST:
            raise ConfigError(f"SPI_BAUD must be {BAUD_LEAST}..{BAUD_MOST}, not {self.baud}")
        if self.gap_sck < 0:
            raise ConfigError(f"the gap between SPI words must be 0 SCK cycles or more, not {self.gap_sck}")

    def sck_hz(self, sclk_hz: Fraction) -> Fraction:
        """Return the rate of SCK: one bit a cycle."""
        return sclk_hz / (2 * self.baud)
