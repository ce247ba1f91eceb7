"""The PPI's registers: fields of CONTROL, bits of STATUS, and the limits of FIFO and clock.

Receive modes with external frame syncs are what cameras use here; the fields of the others are named and no more.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from enum import IntEnum, IntFlag
from fractions import Fraction

from bfsim.chip.bit_fields import BitField, RegisterLayout
from bfsim.errors import ConfigError

# PPI_CONTROL: masks of defBF561.h (Linux arch/blackfin, SRV-1)
PPI_CONTROL = RegisterLayout(
    "PPI_CONTROL",
    (
        BitField("PORT_EN", 0),
        BitField("PORT_DIR", 1),  # 0 receive, 1 transmit
        BitField("XFR_TYPE", 2, 2),
        BitField("PORT_CFG", 4, 2),
        BitField("FLD_SEL", 6),  # ITU-R 656: 0 field 1 only, 1 both
        BitField("PACK_EN", 7),  # two 8-bit samples in 16 bits
        BitField("DMA32", 8),  # 32-bit DMA words
        BitField("SKIP_EN", 9),  # every second sample is dropped
        BitField("SKIP_EO", 10),  # 0 the odd ones, 1 the even ones
        BitField("DLEN", 11, 3),
        BitField("POLC", 14),  # PPI_CLK inverted
        BitField("POLS", 15),  # frame syncs inverted
    ),
)

# DLEN: masks DLEN_8 .. DLEN_16 of defBF537.h; 9 bits do not exist
SAMPLE_BITS = (8, 10, 11, 12, 13, 14, 15, 16)

FIFO_ENTRIES = 16  # [assumed] of 16 bits each; packed, an entry holds two 8-bit samples
PPI_CLK_SHARE = Fraction(1, 2)  # [assumed] of SCLK: the fastest PPI_CLK


class TransferType(IntEnum):
    """XFR_TYPE of a receiving PPI (defBF561.h)."""

    ACTIVE_FIELD_656 = 0
    ENTIRE_FIELD_656 = 1
    VERTICAL_BLANKING_656 = 2
    GENERAL_PURPOSE = 3


class PortConfig(IntEnum):
    """PORT_CFG of a PPI that receives in general-purpose mode. [assumed] all but the second of SRV-1's camera.c."""

    ONE_EXTERNAL_SYNC = 0
    INTERNAL_SYNCS = 1
    EXTERNAL_SYNCS = 2
    SELF_TRIGGER = 3


class PpiStatusBit(IntFlag):
    """Bits of PPI_STATUS (defBF561.h). A read clears the register on the BF561 (Linux mach-bf561 cdefBF561.h)."""

    FLD = 0x0400
    FT_ERR = 0x0800
    OVR = 0x1000
    UNDR = 0x2000
    ERR_DET = 0x4000
    ERR_NCOR = 0x8000


@dataclass(frozen=True, slots=True, kw_only=True)
class PpiControl:
    """What a word in PPI_CONTROL asks for; fields left out are 0."""

    PORT_EN: bool = False
    PORT_DIR: bool = False
    XFR_TYPE: TransferType = TransferType.ACTIVE_FIELD_656
    PORT_CFG: PortConfig = PortConfig.ONE_EXTERNAL_SYNC
    FLD_SEL: bool = False
    PACK_EN: bool = False
    DMA32: bool = False
    SKIP_EN: bool = False
    SKIP_EO: bool = False
    DLEN: int = 0
    POLC: bool = False
    POLS: bool = False

    def __post_init__(self) -> None:
        if self.PACK_EN and self.DLEN:
            raise ConfigError(
                f"PPI_CONTROL: PACK_EN must go with samples of 8 bits, not {self.sample_bits} (DLEN {self.DLEN})"
            )

    @classmethod
    def decode(cls, word: int) -> PpiControl:
        """Return what `word` asks for; raise ConfigError if the PPI cannot do that."""
        values = PPI_CONTROL.decode(word)
        return cls(
            XFR_TYPE=TransferType(values.pop("XFR_TYPE")),
            PORT_CFG=PortConfig(values.pop("PORT_CFG")),
            DLEN=values.pop("DLEN"),
            **{name: bool(value) for name, value in values.items()},
        )

    def encode(self) -> int:
        """Return the word that asks for this."""
        return PPI_CONTROL.encode(asdict(self))

    @property
    def sample_bits(self) -> int:
        """Width of a sample on the pins."""
        return SAMPLE_BITS[self.DLEN]

    @property
    def word_bytes(self) -> int:
        """Bytes of a DMA word."""
        return 4 if self.DMA32 else 2

    @property
    def samples_per_word(self) -> int:
        """Samples in a DMA word; one that is not packed takes 16 bits."""
        return self.word_bytes if self.PACK_EN else self.word_bytes // 2

    @property
    def fifo_samples(self) -> int:
        """Samples that the FIFO holds while the DMA waits for its bus."""
        return 2 * FIFO_ENTRIES if self.PACK_EN else FIFO_ENTRIES


def check_ppi_clk(ppi_clk_hz: Fraction, sclk_hz: Fraction) -> None:
    """Raise ConfigError if PPI_CLK is too fast for the PPI at this SCLK."""
    most_hz = sclk_hz * PPI_CLK_SHARE
    if ppi_clk_hz > most_hz:
        raise ConfigError(
            f"PPI_CLK must be at most SCLK * {PPI_CLK_SHARE} = {float(most_hz) / 1e6:g} MHz, "
            f"not {float(ppi_clk_hz) / 1e6:g} MHz"
        )
