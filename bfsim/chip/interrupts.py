"""Interrupts of the peripherals by chip: the number of each in the system interrupt controller, and its level.

A source that both chips have has the same name on both. The events of the core itself are not here.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Self


class SicInterrupt(IntEnum):
    """A peripheral's interrupt: the number of its bit in SIC_IMASK. `ivg`: its level after reset, 7 for IVG7 to 13."""

    ivg: int

    def __new__(cls, sic_id: int, ivg: int) -> Self:  # noqa: D102 - members are written as (sic_id, ivg)
        member = int.__new__(cls, sic_id)
        member._value_ = sic_id
        member.ivg = ivg
        return member


class Bf561Interrupt(SicInterrupt):
    """Linux arch/blackfin/mach-bf561/include/mach/irq.h; its PPI1 and PPI2 are the manual's PPI0 and PPI1."""

    PLL_WAKEUP = 0, 7
    DMA1_ERROR = 1, 7
    DMA2_ERROR = 2, 7
    IMDMA_ERROR = 3, 7
    PPI0_ERROR = 4, 7
    PPI1_ERROR = 5, 7
    SPORT0_ERROR = 6, 7
    SPORT1_ERROR = 7, 7
    SPI_ERROR = 8, 7
    UART_ERROR = 9, 7
    # DMA1, channels 0 to 11
    PPI0_DMA = 11, 8
    PPI1_DMA = 12, 8
    DMA1_2 = 13, 8
    DMA1_3 = 14, 8
    DMA1_4 = 15, 8
    DMA1_5 = 16, 8
    DMA1_6 = 17, 8
    DMA1_7 = 18, 8
    DMA1_8 = 19, 8
    DMA1_9 = 20, 8
    DMA1_10 = 21, 8
    DMA1_11 = 22, 8
    # DMA2, channels 0 to 11
    SPORT0_RX_DMA = 23, 9
    SPORT0_TX_DMA = 24, 9
    SPORT1_RX_DMA = 25, 9
    SPORT1_TX_DMA = 26, 9
    SPI_DMA = 27, 9
    UART_RX_DMA = 28, 9
    UART_TX_DMA = 29, 9
    DMA2_7 = 30, 9
    DMA2_8 = 31, 9
    DMA2_9 = 32, 9
    DMA2_10 = 33, 9
    DMA2_11 = 34, 9
    TIMER0 = 35, 10
    TIMER1 = 36, 10
    TIMER2 = 37, 10
    TIMER3 = 38, 10
    TIMER4 = 39, 10
    TIMER5 = 40, 10
    TIMER6 = 41, 10
    TIMER7 = 42, 10
    TIMER8 = 43, 10
    TIMER9 = 44, 10
    TIMER10 = 45, 10
    TIMER11 = 46, 10
    PF0_A = 47, 11
    PF0_B = 48, 11
    PF1_A = 49, 11
    PF1_B = 50, 11
    PF2_A = 51, 11
    PF2_B = 52, 11
    MDMA1_0 = 53, 8
    MDMA1_1 = 54, 8
    MDMA2_0 = 55, 9
    MDMA2_1 = 56, 9
    IMDMA_0 = 57, 12
    IMDMA_1 = 58, 12
    WATCHDOG = 59, 13
    SUPPLEMENTAL_0 = 62, 7
    SUPPLEMENTAL_1 = 63, 7


class Bf533Interrupt(SicInterrupt):
    """Linux arch/blackfin/mach-bf533/include/mach/irq.h. Its one PPI is PPI0, its one DMA controller DMA1."""

    PLL_WAKEUP = 0, 7
    DMA1_ERROR = 1, 7
    PPI0_ERROR = 2, 7
    SPORT0_ERROR = 3, 7
    SPORT1_ERROR = 4, 7
    SPI_ERROR = 5, 7
    UART_ERROR = 6, 7
    RTC = 7, 8
    # channels 0 to 7
    PPI0_DMA = 8, 8
    SPORT0_RX_DMA = 9, 9
    SPORT0_TX_DMA = 10, 9
    SPORT1_RX_DMA = 11, 9
    SPORT1_TX_DMA = 12, 9
    SPI_DMA = 13, 10
    UART_RX_DMA = 14, 10
    UART_TX_DMA = 15, 10
    TIMER0 = 16, 11
    TIMER1 = 17, 11
    TIMER2 = 18, 11
    PF0_A = 19, 12
    PF0_B = 20, 12
    MDMA1_0 = 21, 13
    MDMA1_1 = 22, 13
    WATCHDOG = 23, 13
