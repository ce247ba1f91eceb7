"""When operations are issued: how long they wait for pointer registers, and which share a bundle.

A list scheduler over one block: in each cycle it issues the first operation, in program order, whose operands are
ready. A cycle that no operation fills is a stall. Waits across the ends of blocks are not modelled.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.operations import (
    BARRIERS,
    COSTS,
    LOAD_TO_POINTER_STALL,
    LOADS,
    MOVE_TO_POINTER_STALL,
    STORES,
    TESTS,
    Op,
)

BUNDLING = {
    Op.DSP_ALU,
    Op.MUL16,
    Op.MAC,
}  # [PRM] a bundle needs a 32-bit DSP operation; accesses have 16 bits


@dataclass(frozen=True, slots=True)
class Issue:
    """When an operation is issued: after `stall_cclk` idle cycles, or in the same bundle as an earlier one."""

    stall_cclk: int = 0
    paired: bool = False


def issues(
    instructions: Sequence[MachineInstruction],
    bank_of: Callable[[str], RegisterBank | None],
    *,
    parallel: bool,
) -> list[Issue]:
    """Return for each instruction of a block when it is issued; with `parallel`, 32-bit DSP operations take accesses along."""
    behind: list[dict[int, int]] = []
    for number, instruction in enumerate(instructions):
        gaps = {earlier: _gap(instructions[earlier], instruction, bank_of) for earlier in range(number)}
        behind.append({earlier: gap for earlier, gap in gaps.items() if gap is not None})
    issued: dict[int, int] = {}
    found = [Issue()] * len(instructions)
    now = 0
    while len(issued) < len(instructions):
        ready = {
            number: max((issued[before] + gap for before, gap in gaps.items()), default=0)
            for number, gaps in enumerate(behind)
            if number not in issued and all(before in issued for before in gaps)
        }
        number = min(ready, key=lambda each: (max(ready[each], now), each))
        found[number] = Issue(max(0, ready[number] - now))
        now = max(now, ready.pop(number))
        issued[number] = now
        if parallel and instructions[number].op in BUNDLING:
            for other in [
                each
                for each in sorted(ready)
                if ready[each] <= now and instructions[each].op in LOADS | STORES
            ][:1]:
                found[other], issued[other] = Issue(paired=True), now
        now += _cclk(instructions[number])
    return found


def _cclk(instruction: MachineInstruction) -> int:
    return COSTS[instruction.op].cclk if instruction.cclk is None else instruction.cclk


def _gap(
    first: MachineInstruction, then: MachineInstruction, bank_of: Callable[[str], RegisterBank | None]
) -> int | None:
    """The least number of cycles from the issue of `first` to the issue of `then`; None if they are independent."""
    used = {name for name, _ in then.uses}
    if first.result is not None and first.result in used:
        return _cclk(first) + _latency(first, then, bank_of)
    if then.result is not None and (
        then.result == first.result or then.result in {name for name, _ in first.uses}
    ):
        return _cclk(first)
    if {first.op, then.op} & BARRIERS or (first.op in TESTS and then.op in TESTS):
        return _cclk(first)
    if (first.op in STORES and then.op in LOADS | STORES) or (first.op in LOADS and then.op in STORES):
        return _cclk(first)
    return None


def _latency(
    first: MachineInstruction, then: MachineInstruction, bank_of: Callable[[str], RegisterBank | None]
) -> int:
    name = first.result or ""
    if (first.bank if first.bank is not RegisterBank.ANY else bank_of(name)) is not RegisterBank.POINTER:
        return 0
    if first.op is Op.LOAD32:
        return LOAD_TO_POINTER_STALL
    return (
        MOVE_TO_POINTER_STALL
        if first.op is Op.MOVE and first.uses and _comes_from_data(first, bank_of)
        else 0
    )


def _comes_from_data(move: MachineInstruction, bank_of: Callable[[str], RegisterBank | None]) -> bool:
    return bank_of(move.uses[0][0]) is RegisterBank.DATA
