"""Memory DMA of a whole board: buffers in every memory, and what programs a stream to move between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from bfsim.api import Buffer, u8, u16
from bfsim.chip.dma_registers import Flow
from bfsim.machine.dma.config import DmaConfig
from bfsim.machine.dma.descriptors import write_descriptor
from tests.machine.made_boards import CCLK_PER_SCLK, CHIP

DMA = CHIP.dma
NBYTES = 512
SECTIONS = {"L1": "L1_data_a", "L2": "l2_shared", "SDRAM": "sdram_bank2"}
MORE = tuple(
    Buffer(
        f"{use}_{memory}", u16 if use == "chain" else u8, NBYTES // 2 if use == "chain" else NBYTES, section
    )
    for memory, section in SECTIONS.items()
    for use in ("from", "to", "chain")
)
PATHS = [(source, target) for source in SECTIONS for target in SECTIONS]
each_path = pytest.mark.parametrize(("source", "target"), PATHS)

READ, WRITE = DmaConfig(), DmaConfig(WNR=True)
Registers = Mapping[str, int]


def noise(nbytes: int = NBYTES) -> NDArray[np.uint8]:
    """The same random bytes every time."""
    return np.random.default_rng(561).integers(0, 256, nbytes, np.uint8)


def linear(address: int, words: int, word_bytes: int = 4) -> Registers:
    """Registers for words one after the other."""
    return {"START_ADDR": address, "X_COUNT": words, "X_MODIFY": word_bytes}


def on_chip_cclk(units: int, words: int, elements: int, before: int) -> int:
    """Cycles from the start of `units` between L1 and L2, each of so many words and descriptor elements, at a core's cycle.

    The descriptors lie there as well: an element takes a word's time beside its own.
    """
    begin = before
    element_sclk = DMA.descriptor_sclk + int(DMA.on_chip_word_sclk)
    for _ in range(units):
        ready = begin + (DMA.startup_sclk + elements * element_sclk) * CCLK_PER_SCLK
        begin = (
            -(-ready // CCLK_PER_SCLK) * CCLK_PER_SCLK + int(words * DMA.on_chip_word_sclk) * CCLK_PER_SCLK
        )
    return begin - before


def chain(flow: Flow, at: int, units: Sequence[Mapping[str, int]], **fields: Any) -> list[int]:
    """Return the 16-bit words of descriptors one after the other from address `at`; the last one stops."""
    described: list[int] = []
    for number, registers in enumerate(units):
        ends = number == len(units) - 1
        size = len(write_descriptor(flow, **_full(flow, 0, registers, 0)))
        config = DmaConfig(**fields, FLOW=Flow.STOP if ends else flow, NDSIZE=0 if ends else size)
        pointer = at + 2 * (len(described) + size)
        described += write_descriptor(flow, **_full(flow, pointer, registers, config.encode()))
    return described


def _full(flow: Flow, pointer: int, registers: Mapping[str, int], config: int) -> dict[str, int]:
    """Order the registers of a descriptor."""
    link = {} if flow is Flow.ARRAY else {"NEXT_DESC_PTR": pointer & (0xFFFF if flow is Flow.SMALL else -1)}
    rest = {name: registers[name] for name in ("X_COUNT", "X_MODIFY")}
    return {**link, "START_ADDR": registers["START_ADDR"], "CONFIG": config, **rest}
