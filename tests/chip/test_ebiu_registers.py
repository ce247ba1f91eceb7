"""Register words of the SDRAM controller: words that real boot code writes, and every field by itself."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.ebiu_registers import sdram_geometry_of, sdram_timing_of
from bfsim.chip.memory_map import KIB, MIB


@pytest.mark.parametrize(
    ("sdgctl", "cl", "ras", "rp", "rcd", "wr"),
    [
        (0x0091_11CD, 3, 7, 2, 2, 2),  # CM-BF561 and CM-BF533, u-boot
        (0x0091_998F, 3, 6, 3, 3, 2),  # BF561 EZ-KIT
        (0x0091_998D, 3, 6, 3, 3, 2),  # SRV-1: differs in a bit that is no timing
        (0x0091_114D, 3, 5, 2, 2, 2),  # BF561 EZ-KIT, u-boot, 100 MHz
    ],
)
def test_timing_of_known_words(sdgctl: int, cl: int, ras: int, rp: int, rcd: int, wr: int) -> None:
    """The words of the boards and what the boot code's constants in them are called."""
    assert sdram_timing_of(sdgctl) == {"nCL": cl, "nRAS": ras, "nRP": rp, "nRCD": rcd, "nWR": wr}


@given(
    cl=st.integers(2, 3),
    ras=st.integers(1, 15),
    rp=st.integers(1, 7),
    rcd=st.integers(1, 7),
    wr=st.integers(1, 3),
    others=st.integers(0, 2**32 - 1),
)
def test_fields_do_not_mix(cl: int, ras: int, rp: int, rcd: int, wr: int, others: int) -> None:
    """A word put together from the constants of defBF561.h comes apart again, whatever its other bits are."""
    fields_mask = 0x0000_000C | 0x0000_03C0 | 0x0000_3800 | 0x0003_8000 | 0x0018_0000
    word = cl * 0x4 + ras * 0x40 + rp * 0x800 + rcd * 0x8000 + wr * 0x8_0000
    timing = sdram_timing_of(word | others & ~fields_mask)
    assert timing == {"nCL": cl, "nRAS": ras, "nRP": rp, "nRCD": rcd, "nWR": wr}


@pytest.mark.parametrize(
    ("sdbctl", "word_bytes", "page_bytes", "nbytes"),
    [
        (0x13, 4, 2 * KIB, 32 * MIB),  # CM-BF561: 512 columns of 32 bits
        (0x15, 4, 2 * KIB, 64 * MIB),  # BF561 EZ-KIT
        (0x13, 2, 1 * KIB, 32 * MIB),  # CM-BF533: 512 columns of 16 bits
        (0x01, 2, 512, 16 * MIB),  # every field 0
        (0x37, 2, 4 * KIB, 128 * MIB),  # 11 bits of column address
    ],
)
def test_geometry_of_known_words(sdbctl: int, word_bytes: int, page_bytes: int, nbytes: int) -> None:
    """Size and columns of the boards; four internal banks share the size."""
    geometry = sdram_geometry_of(sdbctl, word_bytes)
    assert geometry == {
        "word_bytes": word_bytes,
        "page_bytes": page_bytes,
        "bank_bytes": nbytes // 4,
        "banks": 4,
    }
