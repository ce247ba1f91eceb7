"""Loop headers of two tests: `while a and b` is rotated so that both are made once before the loop, and then at its end [tree-ssa-loop-ch.cc of GCC 12].

LLVM copies only the first test. GCC goes on while the next one also leaves the loop and is computed from values that
the loop carries and that do not change in it: from counters, or from sums if that is enough for a `break`.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from bfsim.kernel.estimate.arithmetic.bits_set import STATEMENTS as WORD_COUNT
from bfsim.kernel.estimate.arithmetic.bits_set import counted_word
from bfsim.kernel.estimate.conditions.short_circuits import SECOND
from bfsim.kernel.estimate.inlining.statements import TEST_SIZE, statement_size
from bfsim.kernel.estimate.jump_threading.flags import JumpThreading
from bfsim.kernel.estimate.loop_copies.copied_header import CopiedHeader
from bfsim.kernel.estimate.loop_copies.values_behind import with_values_chosen_behind
from bfsim.kernel.estimate.loops.same_values import is_same
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import (
    BasicBlock,
    Instruction,
    Routine,
    each_arm,
)

WHILE = re.compile(r"test(\.|$)")
"""The block of the test of a `while`."""
FOR = re.compile(r"for(\.|$)")
"""The block of the test of a `for`."""
MOST_STATEMENTS = 20  # [param_max_loop_header_insns] of both tests


def copy_headers(routine: Routine) -> Routine:
    """Return `routine` with each loop rotated once more if its header is such a test, without an access."""
    return _copied(routine, lambda flow, loop: not _accesses(flow, loop))


def copy_breaks(routine: Routine) -> Routine:
    """Return `routine` with each loop rotated once more if it begins with accesses and such a test, of a `break`."""
    return _copied(routine, lambda flow, loop: _accesses(flow, loop) and _breaks(flow, loop))


def _copied(routine: Routine, wanted: Callable[[ControlFlow, Loop], bool]) -> Routine:
    for header in [loop.header for loop in ControlFlow(routine).loops]:
        flow = ControlFlow(routine)
        loop = next((each for each in flow.loops if each.header == header), None)
        if loop is None or not wanted(flow, loop):
            continue
        flow = ControlFlow(with_values_chosen_behind(flow, loop))
        if _is_copied(flow, loop):
            routine = CopiedHeader(flow, loop).routine()
    return routine


def _accesses(flow: ControlFlow, loop: Loop) -> bool:
    return any(each.opcode in ("load", "store") for each in flow.blocks[loop.header].instructions)


def _breaks(flow: ControlFlow, loop: Loop) -> bool:
    """Whether the header's test is not the one that the loop begins with in the source: that was copied, and is at its end."""
    return flow.blocks[loop.header].terminator.line != flow.blocks[loop.latch].terminator.line


def _is_copied(flow: ControlFlow, loop: Loop) -> bool:
    header = flow.blocks[loop.header]
    inside = [way for way in header.successors if way in loop.blocks]
    ends_below = set(flow.blocks[loop.latch].successors) - loop.blocks and loop.latch != loop.header
    if (
        header.terminator.opcode != "br"
        or len(inside) != 1
        or len(set(header.successors)) != 2
        or not ends_below
    ):
        return False
    if loop.latch.endswith(SECOND):
        return False  # LLVM had joined both tests, so they are at its end
    if (
        WHILE.match(loop.header)
        or FOR.match(loop.header)
        or (inside == [loop.latch] and _is_while_alone(flow.blocks[loop.latch]))
    ):
        return False  # it ended with its `break`: it is a do-while loop already [do_while_loop_p]
    way_out = next(way for way in header.successors if way not in loop.blocks)
    back = [each for each in flow.predecessors[loop.header] if each in loop.blocks]
    is_entered_once = len(flow.predecessors[loop.header]) == len(back) + 1
    alone = flow.predecessors[inside[0]] == [loop.header] and back == [loop.latch] and not flow.is_split(loop)
    if (
        not (alone and is_entered_once)
        or _size(flow, header) > MOST_STATEMENTS
        or _has_phi(flow.blocks[inside[0]])
    ):
        return False
    return _counts(flow, loop) and _uses_are_near(flow, header, inside[0], way_out)


def _is_while_alone(block: BasicBlock) -> bool:
    """Whether a block is the test of a `while`, and nothing is stepped in it."""
    steps = (each for each in block.instructions if each.opcode not in ("phi", "icmp", "br"))
    return WHILE.match(block.label) is not None and not any(steps)


def _size(flow: ControlFlow, header: BasicBlock) -> int:
    """The statements of both tests: the comparison of the first, and all of the second, in which a count of bits is one."""
    statements = sum(statement_size(flow, each) for each in header.instructions if not each.is_call)
    counts = sum(counted_word(flow, each) is not None for each in header.instructions)
    sums = sum(_adds_to_index(flow, each) for each in header.instructions)
    return TEST_SIZE + statements - counts * (WORD_COUNT - 1) - sums


def _adds_to_index(flow: ControlFlow, each: Instruction) -> bool:
    """Whether an address is only the base of another one: GCC adds the indices, and scales their sum."""
    users = flow.users.get(each.result or "", [])
    return (
        each.opcode == "getelementptr"
        and statement_size(flow, each) > 1
        and [user.opcode for user in users] == ["getelementptr"]
    )


def _has_phi(block: BasicBlock) -> bool:
    return any(each.opcode == "phi" for each in block.instructions)


def _counts(flow: ControlFlow, loop: Loop) -> bool:
    """Whether neither side of the header's test is loaded, or computed from a load, without a value that the loop carries."""
    header = flow.blocks[loop.header]
    test = flow.instruction(header.terminator.operands[0])
    if test is None or test.opcode != "icmp" or flow.is_overflow_guard(header):
        return False
    if any(each.is_call for each in header.instructions):
        return False
    if JumpThreading(flow).decides(header.terminator):
        return False  # gone by then
    return all(_is_same(flow, loop, each) or _is_carried(flow, loop, each) for each in test.operands[:2])


def _is_same(flow: ControlFlow, loop: Loop, value: str) -> bool:
    each = flow.instruction(value)
    return flow.is_invariant(value, loop) or (each is not None and is_same(flow, loop, each))


def _is_carried(flow: ControlFlow, loop: Loop, value: str) -> bool:
    """Whether a value of the header is one of its phis, or computed from one, and not loaded."""
    each = flow.instruction(value)
    if each is None or flow.defined[value][0] != loop.header or each.opcode == "load":
        return False
    return each.opcode == "phi" or any(_is_carried(flow, loop, operand) for operand in each.operands)


def _uses_are_near(flow: ControlFlow, header: BasicBlock, inside: str, way_out: str) -> bool:
    """Whether the header's values are only used where just one of its sides leads, or in a phi where the sides join."""
    own = {each.result for each in header.instructions if each.result}
    for block in flow.routine.blocks:
        behind = flow.dominators[block.label]
        for each in block.instructions:
            if block.label == header.label or each.opcode == "phi" or not own & set(each.operands):
                continue
            if inside not in behind and (
                way_out not in behind or flow.predecessors[way_out] != [header.label]
            ):
                return False
        for each in block.instructions if block.label != header.label else ():
            for value, source in each_arm(each) if each.opcode == "phi" else ():
                before = flow.dominators[source]
                near = source == header.label or inside in before
                if value in own and not near:
                    return False
    return True
