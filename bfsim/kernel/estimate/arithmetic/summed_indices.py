"""Indices, added up before they become an address: LLVM makes two addresses of a[i + j], the second j elements after the first.

C compilers add what the source adds: the sum of two words is an index, and its address takes one instruction. Only the
address of a byte that one access uses is such a sum of three in GCC 12's code, too [fitted:
tests/kernel/estimate/memory/test_rows_of_pictures.py]. It is left alone, and so are addresses that a loop steps along,
or that do not change in it: they cost the same either way.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow, pointee_nbytes
from bfsim.kernel.ir.text import Instruction, Routine
from bfsim.kernel.ir.unused import without_unused

INDEX = ".index"


def with_summed_indices(routine: Routine) -> Routine:
    """Return `routine` with one address in place of each such pair."""
    while (shorter := _summed(ControlFlow(routine))) is not None:
        routine = shorter
    return routine


def _summed(flow: ControlFlow) -> Routine | None:
    """The routine with one index for each address of one more level; None if there are none."""
    evolution = ScalarEvolution(flow, InvariantCodeMotion(flow))
    behind = {
        each.result: inner
        for block in flow.routine.blocks
        for each in block.instructions
        if (inner := _inner(flow, each)) is not None and not _is_stepped(flow, evolution, block.label, each)
    }
    if not behind:
        return None
    blocks = []
    for block in flow.routine.blocks:
        rows: list[Instruction] = []
        for each in block.instructions:
            inner = behind.get(each.result)
            rows += [each] if inner is None or each.result is None else _at_once(each, inner)
        blocks.append(replace(block, instructions=tuple(rows)))
    return without_unused(replace(flow.routine, blocks=tuple(blocks)), ("getelementptr",))


def _inner(flow: ControlFlow, each: Instruction) -> Instruction | None:
    """The address that another one is computed from, if it is itself some elements after a third one."""
    if each.opcode != "getelementptr" or not each.operands[-1].startswith("%"):
        return None
    inner = flow.instruction(each.operands[0])
    if inner is None or inner.opcode != "getelementptr" or not inner.operands[-1].startswith("%"):
        return None
    if pointee_nbytes(each) == 1 and len(flow.users.get(each.result or "", ())) == 1:
        return None
    return inner if _kind(inner) == _kind(each) and _inner(flow, inner) is None else None


def _is_stepped(flow: ControlFlow, evolution: ScalarEvolution, label: str, each: Instruction) -> bool:
    """Whether the loop around a block steps an address along, or leaves it unchanged."""
    loop = flow.innermost(label)
    return loop is not None and evolution.increment(each.result or "", loop) is not None


def _kind(each: Instruction) -> str:
    return each.text.split(" ptr ")[0]


def _at_once(each: Instruction, inner: Instruction) -> Iterator[Instruction]:
    first, last = inner.operands[-1], each.operands[-1]
    index = f"{each.result}{INDEX}" if INDEX not in last else f"{last}{INDEX}"
    yield replace(each, result=index, opcode="add", text=f"add i32 {first}, {last}", operands=(first, last))
    text = f"{_kind(each)} ptr {inner.operands[0]}, i32 {index}"
    yield replace(each, text=text, operands=(inner.operands[0], index))
