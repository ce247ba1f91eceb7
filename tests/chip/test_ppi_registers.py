"""PPI registers: words of real firmware, words that cannot be, and the limits."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.ppi_registers import (
    PPI_CONTROL,
    PortConfig,
    PpiControl,
    TransferType,
    check_ppi_clk,
)
from bfsim.errors import ConfigError

MHZ = 1_000_000


def test_control_word_of_a_camera_on_a_general_purpose_port() -> None:
    """PACK_EN | PORT_CFG 0x20 | XFR_TYPE 0x0C, as SRV-1 has it: two samples in a 16-bit word."""
    control = PpiControl.decode(0x00AC)
    assert control == PpiControl(
        XFR_TYPE=TransferType.GENERAL_PURPOSE, PORT_CFG=PortConfig.EXTERNAL_SYNCS, PACK_EN=True
    )
    assert (control.sample_bits, control.word_bytes, control.samples_per_word) == (8, 2, 2)


@pytest.mark.parametrize(
    ("word", "word_bytes", "samples_per_word", "fifo_samples"),
    [(0x0000, 2, 1, 16), (0x0080, 2, 2, 32), (0x0100, 4, 2, 16), (0x0180, 4, 4, 32)],
    ids=["plain", "PACK_EN", "DMA32", "PACK_EN and DMA32"],
)
def test_packing(word: int, word_bytes: int, samples_per_word: int, fifo_samples: int) -> None:
    """UYVY with PACK_EN and DMA32 is one word for two pixels."""
    control = PpiControl.decode(word)
    assert (control.word_bytes, control.samples_per_word) == (word_bytes, samples_per_word)
    assert control.fifo_samples == fifo_samples


@pytest.mark.parametrize(
    ("mask", "name"),
    [
        (0x0001, "PORT_EN"),
        (0x0002, "PORT_DIR"),
        (0x000C, "XFR_TYPE"),
        (0x0030, "PORT_CFG"),
        (0x0040, "FLD_SEL"),
        (0x0080, "PACK_EN"),
        (0x0100, "DMA32"),
        (0x0200, "SKIP_EN"),
        (0x0400, "SKIP_EO"),
        (0x3800, "DLEN"),
        (0x4000, "POLC"),
        (0x8000, "POLS"),
    ],
)
def test_masks_are_those_of_the_headers(mask: int, name: str) -> None:
    """Each mask of defBF561.h sets its own field and no other."""
    values = PPI_CONTROL.decode(mask)
    assert [each for each, value in values.items() if value] == [name]
    assert all(
        value == each.largest
        for each, value in zip(PPI_CONTROL.fields, values.values(), strict=True)
        if value
    )


@given(st.integers(0, 0xFFFF).filter(lambda word: not word & 0x80 or not word & 0x3800))
def test_every_legal_word_survives(word: int) -> None:
    """Decoding and encoding lose nothing."""
    assert PpiControl.decode(word).encode() == word


@pytest.mark.parametrize(("dlen", "bits"), [(0, 8), (1, 10), (2, 11), (7, 16)])
def test_there_is_no_dlen_for_nine_bits(dlen: int, bits: int) -> None:
    """DLEN_10 is 0x0800: the next after 8 bits."""
    assert PpiControl(DLEN=dlen).sample_bits == bits


def test_wide_samples_are_not_packed() -> None:
    """Packing puts two samples in 16 bits."""
    with pytest.raises(ConfigError, match=r"PACK_EN must go with samples of 8 bits, not 10 \(DLEN 1\)"):
        PpiControl.decode(0x0880)


def test_a_word_has_16_bits() -> None:
    """The message shows which bits are too many."""
    with pytest.raises(
        ConfigError, match=r"PPI_CONTROL must have its reserved bits 0, not 0x10000 \(in 0x100AC\)"
    ):
        PpiControl.decode(0x100AC)


def test_a_value_must_fit_its_field() -> None:
    """Register and field are named."""
    with pytest.raises(ConfigError, match=r"PPI_CONTROL.DLEN must be 0..7, not 8"):
        PPI_CONTROL.encode(PPI_CONTROL.decode(0) | {"DLEN": 8})


def test_fastest_clock() -> None:
    """Half of SCLK is allowed, and not a Hertz more."""
    check_ppi_clk(Fraction(60 * MHZ), Fraction(120 * MHZ))
    with pytest.raises(ConfigError, match=r"PPI_CLK must be at most SCLK \* 1/2 = 50 MHz, not 54 MHz"):
        check_ppi_clk(Fraction(54 * MHZ), Fraction(100 * MHZ))
    with pytest.raises(ConfigError):
        check_ppi_clk(Fraction(60 * MHZ + 1), Fraction(120 * MHZ))
