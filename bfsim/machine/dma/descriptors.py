"""DMA descriptors: the 16-bit words in memory that a channel loads its registers from."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from bfsim.chip.dma_registers import DESCRIPTOR_ELEMENTS, ELEMENT_BYTES, ELEMENTS, REGISTERS, Flow
from bfsim.errors import MmrError
from bfsim.machine.dma.mmr import check_value

Read16 = Callable[[int], int]
"""Reads the little-endian 16-bit word at a byte address."""


def read_descriptor(read16: Read16, pointer: int, flow: Flow, ndsize: int) -> dict[str, int]:
    """Return the first `ndsize` elements of the descriptor at byte address `pointer`, by name, 16 bits each."""
    names = DESCRIPTOR_ELEMENTS[flow][:ndsize]
    return {name: read16(pointer + number * ELEMENT_BYTES) for number, name in enumerate(names)}


def load(registers: Mapping[str, int], elements: Mapping[str, int]) -> dict[str, int]:
    """Return `registers` with `elements` of a descriptor in their places. Everything else keeps its value."""
    loaded = dict(registers)
    for name, element in elements.items():
        register, position = ELEMENTS[name]
        spec = REGISTERS[register]
        kept = loaded[register] & (1 << spec.bits) - 1 & ~(0xFFFF << position)
        value = kept | element << position
        loaded[register] = value - (1 << spec.bits) if value > spec.highest else value
    return loaded


def write_descriptor(flow: Flow, **registers: int) -> list[int]:
    """Return the 16-bit words of a descriptor that fills `registers`. The number of words is its NDSIZE.

    For a ring of buffers in a large list: `write_descriptor(Flow.LARGE, NEXT_DESC_PTR=..., START_ADDR=...)`.
    A descriptor fills NEXT_DESC_PTR (lists only), START_ADDR, CONFIG, X_COUNT, X_MODIFY, Y_COUNT, Y_MODIFY up to any
    of them, without gaps. A small list has only the lower half of NEXT_DESC_PTR.
    """
    if flow not in DESCRIPTOR_ELEMENTS:
        raise MmrError(f"a descriptor is for FLOW ARRAY, SMALL or LARGE, not {flow.name}")
    order = tuple(dict.fromkeys(ELEMENTS[name][0] for name in DESCRIPTOR_ELEMENTS[flow]))
    filled = order[: len(registers)]
    if not registers or set(registers) != set(filled):
        raise MmrError(
            f"a descriptor for FLOW={flow.name} must fill the first of {', '.join(order)}, "
            f"not {', '.join(registers) or 'nothing'}"
        )
    for register, value in registers.items():
        spec = REGISTERS[register]
        check_value(register, value, spec.lowest, spec.highest, "in a descriptor")
    places = [ELEMENTS[name] for name in DESCRIPTOR_ELEMENTS[flow]]
    return [registers[register] >> position & 0xFFFF for register, position in places if register in filled]
