"""The SPI's registers: fields of CTL, the rate that BAUD sets, and how long words take on the wire."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from enum import IntEnum
from fractions import Fraction

from bfsim.chip.bit_fields import BitField, RegisterLayout
from bfsim.clocks import Clocks
from bfsim.errors import ConfigError

# SPI_CTL: masks of defBF561.h (Linux arch/blackfin)
SPI_CTL = RegisterLayout(
    "SPI_CTL",
    (
        BitField("TIMOD", 0, 2),
        BitField("SZ", 2),  # what to send when there is nothing: 0 the last word, 1 zeros
        BitField("GM", 3),  # what to do with a word when the last is not read: 0 discard, 1 overwrite
        BitField("PSSE", 4),  # slave select is an input
        BitField("EMISO", 5),  # MISO is an output
        BitField("SIZE", 8),  # 0 words of 8 bits, 1 of 16
        BitField("LSBF", 9),
        BitField("CPHA", 10),
        BitField("CPOL", 11),
        BitField("MSTR", 12),
        BitField("WOM", 13),  # open drain
        BitField("SPE", 14),
    ),
)

BAUD_LEAST = 2  # Linux bfin5xx_spi.h MIN_SPI_BAUD_VAL: at most SCLK / 4
BAUD_MOST = 0xFFFF  # SPI_BAUD has 16 bits


class TransferInitiation(IntEnum):
    """TIMOD: what starts a transfer (defBF561.h). DMA goes one way at a time."""

    READ_RDBR = 0
    WRITE_TDBR = 1
    DMA_RECEIVE = 2
    DMA_TRANSMIT = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class SpiControl:
    """What a word in SPI_CTL asks for; fields left out are 0."""

    TIMOD: TransferInitiation = TransferInitiation.READ_RDBR
    SZ: bool = False
    GM: bool = False
    PSSE: bool = False
    EMISO: bool = False
    SIZE: bool = False
    LSBF: bool = False
    CPHA: bool = False
    CPOL: bool = False
    MSTR: bool = False
    WOM: bool = False
    SPE: bool = False

    @classmethod
    def decode(cls, word: int) -> SpiControl:
        """Return what `word` asks for; raise ConfigError if a reserved bit is set."""
        values = SPI_CTL.decode(word)
        return cls(
            TIMOD=TransferInitiation(values.pop("TIMOD")),
            **{name: bool(value) for name, value in values.items()},
        )

    def encode(self) -> int:
        """Return the word that asks for this."""
        return SPI_CTL.encode(asdict(self))

    @property
    def word_bits(self) -> int:
        """Bits of a word on the wire."""
        return 16 if self.SIZE else 8


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

    def transfer_ticks(self, clocks: Clocks, words: int, word_bits: int = 16) -> Fraction:
        """Return the ticks from the first bit of `words` words to the last; no gap follows the last word."""
        if not words:
            return Fraction(0)
        sck_cycles = words * word_bits + (words - 1) * self.gap_sck
        return sck_cycles * clocks.tick_hz / self.sck_hz(clocks.sclk_hz)
