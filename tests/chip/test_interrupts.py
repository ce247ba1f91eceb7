"""The system interrupt controllers: numbers and levels against the manual's tables, and names that both chips share."""

from __future__ import annotations

import pytest

from bfsim.chip.interrupts import Bf533Interrupt, Bf561Interrupt, SicInterrupt


@pytest.mark.parametrize(
    ("name", "sic_id", "ivg"),
    [
        ("PLL_WAKEUP", 0, 7),
        ("DMA1_ERROR", 1, 7),
        ("DMA2_ERROR", 2, 7),
        ("IMDMA_ERROR", 3, 7),
        ("PPI0_ERROR", 4, 7),
        ("PPI1_ERROR", 5, 7),
        ("SPI_ERROR", 8, 7),
        ("PPI0_DMA", 11, 8),
        ("PPI1_DMA", 12, 8),
        ("SPI_DMA", 27, 9),
        ("TIMER0", 35, 10),
        ("PF0_A", 47, 11),
        ("PF2_B", 52, 11),
        ("MDMA1_0", 53, 8),
        ("MDMA1_1", 54, 8),
        ("MDMA2_0", 55, 9),
        ("MDMA2_1", 56, 9),
        ("IMDMA_0", 57, 12),
        ("IMDMA_1", 58, 12),
        ("WATCHDOG", 59, 13),
        ("SUPPLEMENTAL_0", 62, 7),
        ("SUPPLEMENTAL_1", 63, 7),
    ],
)
def test_bf561_interrupts(name: str, sic_id: int, ivg: int) -> None:
    """Number and level of what the machine raises."""
    assert (Bf561Interrupt[name], Bf561Interrupt[name].ivg) == (sic_id, ivg)


@pytest.mark.parametrize(
    ("name", "sic_id", "ivg"),
    [
        ("PLL_WAKEUP", 0, 7),
        ("PPI0_ERROR", 2, 7),
        ("RTC", 7, 8),
        ("PPI0_DMA", 8, 8),
        ("SPI_DMA", 13, 10),
        ("TIMER0", 16, 11),
        ("PF0_A", 19, 12),
        ("MDMA1_1", 22, 13),
        ("WATCHDOG", 23, 13),
    ],
)
def test_bf533_interrupts(name: str, sic_id: int, ivg: int) -> None:
    """The single core has other numbers for the same names."""
    assert (Bf533Interrupt[name], Bf533Interrupt[name].ivg) == (sic_id, ivg)


@pytest.mark.parametrize(
    ("interrupts", "count", "reserved"), [(Bf561Interrupt, 64, {10, 60, 61}), (Bf533Interrupt, 24, set())]
)
def test_every_bit_has_one_source(interrupts: type[SicInterrupt], count: int, reserved: set[int]) -> None:
    """No number is forgotten or taken twice, and every level is one that a peripheral can have."""
    assert len(interrupts) == len(interrupts.__members__)
    assert {int(each) for each in interrupts} | reserved == set(range(count))
    assert {each.ivg for each in interrupts} <= set(range(7, 14))


@pytest.mark.parametrize(("first", "channels"), [("PPI0_DMA", 12), ("SPORT0_RX_DMA", 12)])
def test_dma_channels_have_numbers_in_a_row(first: str, channels: int) -> None:
    """Channel n of a controller of the BF561 is n behind its channel 0, at the same level."""
    start = Bf561Interrupt[first]
    row = [Bf561Interrupt(start + channel) for channel in range(channels)]
    assert {each.ivg for each in row} == {start.ivg}


def test_both_chips_call_the_same_source_the_same() -> None:
    """What a board with either chip raises is found by one name."""
    assert set(Bf533Interrupt.__members__) - set(Bf561Interrupt.__members__) == {"RTC"}
