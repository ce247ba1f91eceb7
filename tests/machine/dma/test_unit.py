"""Work units: the walk word by word, as the manual tells it, against the closed forms."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.dma_registers import WdSize
from bfsim.machine.dma.config import DmaConfig
from bfsim.machine.dma.unit import WorkUnit


def walk(unit: WorkUnit) -> Iterator[int]:
    """The address of each word: X_MODIFY after a word, but Y_MODIFY instead after the last one of a row."""
    address = unit.start_address
    for _ in range(unit.y_count):
        for column in range(unit.x_count):
            yield address
            address += unit.x_modify if column < unit.x_count - 1 else unit.y_modify


units = st.builds(
    WorkUnit,
    start_address=st.integers(0, 1 << 20),
    x_count=st.integers(1, 20),
    x_modify=st.integers(-40, 40),
    y_count=st.integers(1, 20),
    y_modify=st.integers(-400, 400),
    word_bytes=st.sampled_from([1, 2, 4]),
    write=st.booleans(),
)


@given(units)
def test_closed_forms_agree_with_the_walk(unit: WorkUnit) -> None:
    """Order, number, bytes and extremes, strides of either sign."""
    addresses = list(walk(unit))
    assert unit.addresses().tolist() == addresses
    assert unit.words == len(addresses)
    assert unit.nbytes == len(addresses) * unit.word_bytes
    assert unit.span == (min(addresses), max(addresses) + unit.word_bytes - 1)
    assert [unit.row_address(row) for row in range(unit.y_count)] == addresses[:: unit.x_count]
    assert unit.end_address == addresses[-1] + unit.x_modify


def unit_of(config: DmaConfig, x_count: int = 4, y_count: int = 3) -> WorkUnit:
    """What rows of 16-bit words become under `config`."""
    return WorkUnit.programmed(
        config, start_address=0x100, x_count=x_count, x_modify=2, y_count=y_count, y_modify=-8
    )


def test_without_dma2d_the_y_registers_are_ignored() -> None:
    """One row, one interrupt at its end, whatever DI_SEL says."""
    flat = unit_of(DmaConfig(WDSIZE=WdSize.WDSIZE_16, DI_EN=True, DI_SEL=True))
    assert flat.addresses().tolist() == [0x100, 0x102, 0x104, 0x106]
    assert (flat.y_count, flat.y_modify) == (1, 0)
    assert (flat.row_interrupt, flat.block_interrupt) == (False, True)


@pytest.mark.parametrize(
    ("enabled", "per_row", "interrupts"),
    [
        (False, False, (False, False)),
        (False, True, (False, False)),
        (True, False, (False, True)),
        (True, True, (True, False)),
    ],
)
def test_di_sel_chooses_rows_or_block(enabled: bool, per_row: bool, interrupts: tuple[bool, bool]) -> None:
    """DI_SEL says nothing without DI_EN."""
    unit = unit_of(DmaConfig(WDSIZE=WdSize.WDSIZE_16, DMA2D=True, DI_EN=enabled, DI_SEL=per_row))
    assert (unit.row_interrupt, unit.block_interrupt) == interrupts


def test_counts_of_zero_are_65536() -> None:
    """The closed forms hold for the largest unit, which nobody walks."""
    unit = unit_of(DmaConfig(DMA2D=True), x_count=0, y_count=0)
    assert (unit.x_count, unit.y_count, unit.words) == (65536, 65536, 1 << 32)
    assert unit.span == (0x100, 0x100 + 65535 * 2 + 65535 * (65535 * 2 - 8) + 3)


def test_one_colour_of_an_interleaved_row() -> None:
    """X_MODIFY 4 takes every second byte pair: the Y0 of each UYVY word in two rows of a picture 16 bytes wide."""
    unit = WorkUnit(start_address=1, x_count=4, x_modify=4, y_count=2, y_modify=4, word_bytes=1, write=False)
    assert unit.addresses().tolist() == [1, 5, 9, 13, 17, 21, 25, 29]


def test_a_picture_can_be_turned_upside_down() -> None:
    """Y_MODIFY leads back from the end of a row to the start of the row above."""
    unit = WorkUnit(
        start_address=32, x_count=4, x_modify=4, y_count=3, y_modify=-28, word_bytes=4, write=True
    )
    assert unit.addresses().tolist() == [32, 36, 40, 44, 16, 20, 24, 28, 0, 4, 8, 12]
    assert unit.span == (0, 47)
