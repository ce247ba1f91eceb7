"""Bytes are decoded, printed, run and counted."""

from __future__ import annotations

import pytest

from bfsim.blackfin.control_flow import blocks
from bfsim.blackfin.execution.processor import OUTSIDE, AccessError
from bfsim.blackfin.instructions.decode import InstructionError, decode, disassemble
from bfsim.blackfin.instructions.event import Event
from bfsim.blackfin.instructions.text import text
from tests.blackfin.code import CODE, DATA, processor

SUM = "2860 5068 a2e0 0300 0964 0850 1000"
"""R0 = 5; P0 = 10; ten times R1 += 1, R0 = R0 + R1; back."""


def test_instructions_are_printed_as_objdump_does() -> None:
    assert [text(each) for each in disassemble(bytes.fromhex(SUM), CODE)] == [
        "R0 = 0x5 (X)",
        "P0 = 0xa (X)",
        "LSETUP(0x1008, 0x100a) LC0 = P0",
        "R1 += 0x1",
        "R0 = R0 + R1",
        "RTS",
    ]


def test_a_hardware_loop_runs_as_often_as_its_counter_says_and_its_cycles_are_counted() -> None:
    core = processor(SUM)
    assert core.call(CODE) is Event.UNKNOWN_TARGET
    assert core.state["PC"] == OUTSIDE
    assert (core.state["R0"], core.state["R1"], core.state["LC0"]) == (5 + sum(range(1, 11)), 10, 0)
    assert core.state["CLOCK"] == 3 + 10 * 2 + 5


def test_bytes_that_are_no_instruction_are_refused_with_address_and_bytes() -> None:
    with pytest.raises(InstructionError, match="0x00001000, .* none of a Blackfin: ff ff ff ff"):
        decode(b"\xff\xff\xff\xff", CODE)
    with pytest.raises(InstructionError, match="0x00001002, .*: ff ff"):
        processor("2860 ffff").call(CODE)


def test_a_jump_into_memory_of_zeros_is_refused_before_all_of_it_is_code(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A zero is a NOP: a wild call could reach millions of them."""
    monkeypatch.setattr(blocks, "MOST_INSTRUCTIONS", 1000)
    with pytest.raises(
        InstructionError, match="at most 1,000 instructions, .* from 0x00001000 .* at 0x000017d0; jumps must"
    ):
        processor("0000").call(CODE)


def test_an_access_without_memory_is_refused_and_the_process_goes_on() -> None:
    core = processor("0091 1000", P0=0xDEADBEE0)  # R0 = [P0]; RTS
    for _ in range(2):
        with pytest.raises(AccessError, match="started at 0x00001000 accesses 0xdeadbee0"):
            core.call(CODE)
    core.state["P0"] = DATA
    assert core.call(CODE) is Event.UNKNOWN_TARGET


def test_an_access_over_the_end_of_the_address_space_is_refused() -> None:
    with pytest.raises(AccessError, match="accesses 0xffff"):
        processor("0091 1000", P0=0xFFFFFFFE).call(CODE)


def test_an_endless_loop_uses_up_its_fuel() -> None:
    assert processor("0020").call(CODE) is Event.FUEL
