"""SPI registers: words of real firmware, the rates of BAUD, and the time of a transfer in closed form."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.boards import CM_BF561, CM_BF561_RATINGS
from bfsim.chip.spi_registers import SPI_CTL, SpiControl, SpiRate, TransferInitiation
from bfsim.errors import ConfigError

MHZ = 1_000_000
GAPLESS = Fraction(0)


def test_control_word_of_a_16_bit_master() -> None:
    """SPE | 0x1101 of a public BF533 project: master, 16 bits, started by a write of TDBR."""
    control = SpiControl.decode(0x5101)
    assert control == SpiControl(TIMOD=TransferInitiation.WRITE_TDBR, SIZE=True, MSTR=True, SPE=True)
    assert control.word_bits == 16
    assert SpiControl().word_bits == 8


@given(st.integers(0, 0xFFFF).map(lambda word: word & 0x7F3F))
def test_every_legal_word_survives(word: int) -> None:
    """Decoding and encoding lose nothing."""
    assert SpiControl.decode(word).encode() == word


@pytest.mark.parametrize("bit", [0x40, 0x80, 0x8000])
def test_reserved_bits_are_refused(bit: int) -> None:
    """Bits 6, 7 and 15 have no meaning."""
    with pytest.raises(ConfigError, match=f"SPI_CTL must have its reserved bits 0, not 0x{bit:X}"):
        SPI_CTL.decode(bit)


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


def test_one_word_at_the_highest_rate() -> None:
    """16 bits at 30 MHz are 0.533 us, 320 cycles of 600 MHz; a gap comes between words, not behind the last."""
    assert SpiRate(baud=2).transfer_ticks(CM_BF561.clocks, words=1) == 320
    assert SpiRate(baud=2).transfer_ticks(CM_BF561.clocks, words=2) == 320 + 20 + 320
    assert SpiRate(baud=2).transfer_ticks(CM_BF561.clocks, words=0) == 0
    assert SpiRate(baud=2).transfer_ticks(CM_BF561.clocks, words=1, word_bits=8) == 160


def test_a_packet_of_256_bytes() -> None:
    """68 us without gaps."""
    ticks = SpiRate(baud=2, gap_sck=GAPLESS).transfer_ticks(CM_BF561.clocks, words=128)
    assert ticks / CM_BF561.clocks.tick_hz == Fraction(128 * 16, 30 * MHZ)
    assert float(ticks / CM_BF561.clocks.tick_hz) == pytest.approx(68e-6, rel=0.01)


@given(words=st.integers(1, 10**6), baud=st.integers(2, 0xFFFF), gap=st.fractions(0, 4, max_denominator=8))
def test_a_transfer_is_exact_at_any_clock(words: int, baud: int, gap: Fraction) -> None:
    """In seconds it is bits and gaps over SCK, also where SCLK is no whole number of Hertz."""
    clocks = CM_BF561_RATINGS.clocks
    rate = SpiRate(baud=baud, gap_sck=gap)
    seconds = (words * (16 + gap) - gap) / rate.sck_hz(clocks.sclk_hz)
    assert rate.transfer_ticks(clocks, words) == seconds * clocks.tick_hz
