"""Descriptors as words in memory: written and read again, whole and cut short."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.dma_registers import NDSIZE_LIMITS, REGISTERS, Flow
from bfsim.errors import MmrError
from bfsim.machine.dma.channel import LOADED
from bfsim.machine.dma.descriptors import load, read_descriptor, write_descriptor
from tests.machine.dma.dma_rig import Memory

OLD = dict.fromkeys(LOADED, 0) | {"NEXT_DESC_PTR": 0xFF90_1234, "X_MODIFY": -2, "Y_MODIFY": -1}
values = st.fixed_dictionaries(
    {each: st.integers(REGISTERS[each].lowest, REGISTERS[each].highest) for each in LOADED}
)


def read_back(flow: Flow, words: list[int]) -> dict[str, int]:
    """The elements of a descriptor that was put at some address."""
    memory = Memory()
    memory.put(0x2000, words)
    return read_descriptor(memory.words.__getitem__, 0x2000, flow, len(words))


def test_the_order_of_a_large_descriptor() -> None:
    """NDPL NDPH SAL SAH CONFIG X_COUNT X_MODIFY Y_COUNT Y_MODIFY."""
    words = write_descriptor(
        Flow.LARGE,
        NEXT_DESC_PTR=0x1111_2222,
        START_ADDR=0x3333_4444,
        CONFIG=0x749B,
        X_COUNT=5,
        X_MODIFY=-4,
        Y_COUNT=7,
        Y_MODIFY=8,
    )
    assert words == [0x2222, 0x1111, 0x4444, 0x3333, 0x749B, 5, 0xFFFC, 7, 8]
    assert list(read_back(Flow.LARGE, words)) == [
        "NDPL",
        "NDPH",
        "SAL",
        "SAH",
        "CONFIG",
        "X_COUNT",
        "X_MODIFY",
        "Y_COUNT",
        "Y_MODIFY",
    ]


def test_the_order_of_the_others() -> None:
    """A small list has half a pointer, an array none."""
    assert write_descriptor(Flow.SMALL, NEXT_DESC_PTR=0x1111_2222, START_ADDR=0x3333_4444) == [
        0x2222,
        0x4444,
        0x3333,
    ]
    assert write_descriptor(Flow.ARRAY, START_ADDR=0x3333_4444) == [0x4444, 0x3333]


@given(values, st.sampled_from([Flow.SMALL, Flow.LARGE]))
def test_a_full_list_descriptor_loads_what_was_written(registers: dict[str, int], flow: Flow) -> None:
    """All seven registers; of the pointer a small list loads the lower half."""
    loaded = load(OLD, read_back(flow, write_descriptor(flow, **registers)))
    if flow is Flow.SMALL:
        registers["NEXT_DESC_PTR"] = 0xFF90_0000 | registers["NEXT_DESC_PTR"] & 0xFFFF
    assert loaded == registers


@given(values)
def test_an_array_loads_no_pointer(registers: dict[str, int]) -> None:
    """NEXT_DESC_PTR stays."""
    del registers["NEXT_DESC_PTR"]
    loaded = load(OLD, read_back(Flow.ARRAY, write_descriptor(Flow.ARRAY, **registers)))
    assert loaded == registers | {"NEXT_DESC_PTR": OLD["NEXT_DESC_PTR"]}


@given(values, st.integers(1, 9))
def test_elements_past_ndsize_keep_the_old_values(registers: dict[str, int], ndsize: int) -> None:
    """Also when NDSIZE cuts an address in halves; nothing past the cut is read."""
    words = write_descriptor(Flow.LARGE, **registers)
    loaded = load(OLD, read_back(Flow.LARGE, words[:ndsize]))
    complete = [2, 4, 5, 6, 7, 8, 9]  # elements after which each register is loaded
    for register, needed in zip(LOADED, complete, strict=True):
        if ndsize >= needed:
            assert loaded[register] == registers[register]
        elif ndsize < needed - 1 or register not in {"NEXT_DESC_PTR", "START_ADDR"}:
            assert loaded[register] == OLD[register]
        else:
            assert loaded[register] == (OLD[register] & 0xFFFF_0000) | (registers[register] & 0xFFFF)


@pytest.mark.parametrize("flow", [Flow.ARRAY, Flow.SMALL, Flow.LARGE])
@given(registers=values)
def test_the_longest_descriptor_has_the_greatest_ndsize(flow: Flow, registers: dict[str, int]) -> None:
    """7, 8 and 9 elements."""
    if flow is Flow.ARRAY:
        del registers["NEXT_DESC_PTR"]
    assert len(write_descriptor(flow, **registers)) == NDSIZE_LIMITS[flow][1]


ORDER = "START_ADDR, CONFIG, X_COUNT, X_MODIFY, Y_COUNT, Y_MODIFY"


@pytest.mark.parametrize(
    ("flow", "registers", "message"),
    [
        (Flow.STOP, {"START_ADDR": 0}, "a descriptor is for FLOW ARRAY, SMALL or LARGE, not STOP"),
        (
            Flow.LARGE,
            {"START_ADDR": 0},
            f"a descriptor for FLOW=LARGE must fill the first of NEXT_DESC_PTR, {ORDER}, not START_ADDR",
        ),
        (
            Flow.ARRAY,
            {"START_ADDR": 0, "X_COUNT": 1},
            f"a descriptor for FLOW=ARRAY must fill the first of {ORDER}, not START_ADDR, X_COUNT",
        ),
        (Flow.ARRAY, {}, f"a descriptor for FLOW=ARRAY must fill the first of {ORDER}, not nothing"),
        (Flow.ARRAY, {"START_ADDR": -1}, "START_ADDR must be 0..4294967295, not -1 (in a descriptor)"),
        (
            Flow.ARRAY,
            {"START_ADDR": 0, "CONFIG": 0, "X_COUNT": 65536},
            "X_COUNT must be 0..65535, not 65536 (in a descriptor)",
        ),
    ],
)
def test_descriptors_that_cannot_be_written(flow: Flow, registers: dict[str, int], message: str) -> None:
    """Gaps, other flows and numbers that do not fit."""
    with pytest.raises(MmrError) as error:
        write_descriptor(flow, **registers)
    assert str(error.value) == message
