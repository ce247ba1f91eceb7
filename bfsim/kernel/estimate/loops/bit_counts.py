"""Loops that compilers replace by an instruction.

Counting the bits of a word is ONES on the Blackfin: GCC knows the number of iterations of `while x: x &= x - 1`
[number_of_iterations_popcount in tree-ssa-loop-niter.cc].
"""

from __future__ import annotations

from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import arms_of
from bfsim.kernel.operations import Op

ALLOWED = {"phi", "add", "and", "icmp", "br"}


def bit_counting_loops(flow: ControlFlow, evolution: ScalarEvolution) -> dict[str, Loop]:
    """Return the loops, by their only block, that only count how often x & (x - 1) leaves something."""
    return {
        loop.header: loop
        for loop in flow.loops
        if len(loop.blocks) == 1 and _counts_bits(flow, evolution, loop)
    }


def _counts_bits(flow: ControlFlow, evolution: ScalarEvolution, loop: Loop) -> bool:
    rows = flow.blocks[loop.header].instructions
    if any(each.opcode not in ALLOWED for each in rows):
        return False
    words = 0
    for phi in (each for each in rows if each.opcode == "phi"):
        update = arms_of(phi)[loop.header]
        each = flow.instruction(update)
        less = (
            [flow.instruction(operand) for operand in each.operands] if each and each.opcode == "and" else []
        )
        clears = any(one and one.opcode == "add" and one.operands == (phi.result, "-1") for one in less)
        words += clears
        if not clears and evolution.gain(phi.result or "", loop) is None:
            return False
    return words == 1


def counting_ops(flow: ControlFlow, loop: Loop) -> list[Op]:
    """Return the operations in place of a loop that counts bits: ONES gives a half-word, which is extended where it is wanted as a word.

    The number of iterations is 1 if no bit is set. GCC tests for that once more if the test before the loop is of other
    values: for `a ^ b`, a != b [`may_be_zero` of number_of_iterations_popcount in tree-ssa-loop-niter.cc].
    """
    starts = [
        value
        for each in flow.blocks[loop.header].instructions
        if each.opcode == "phi"
        for label, value in arms_of(each).items()
        if label != loop.header
    ]
    adds = not {"0"} & {*starts}
    if _tests_others(flow, loop, starts):
        return [Op.ALU, Op.EXTEND, Op.COMPARE, Op.COND_MOVE, *([Op.ALU] * 3 if adds else [])]
    return [Op.ALU, *([] if _is_stored_narrow(flow, loop) else [Op.EXTEND]), *([Op.ALU] if adds else [])]


def _tests_others(flow: ControlFlow, loop: Loop, words: list[str]) -> bool:
    """Whether the test that leads to a loop compares the values that a 32-bit word is made from."""
    label = flow.entering(loop)
    while len(set(flow.blocks[label].successors)) == 1 and len(flow.predecessors[label]) == 1:
        (label,) = flow.predecessors[label]
    condition = flow.blocks[label].terminator.operands[:1]
    test = flow.instruction(condition[0]) if condition else None
    made = [
        each for each in map(flow.instruction, words) if each is not None and each.opcode in ("xor", "sub")
    ]
    return test is not None and any({*each.operands} == {*test.operands} for each in made)


def _is_stored_narrow(flow: ControlFlow, loop: Loop) -> bool:
    """Whether the count is only stored, in fewer than 32 bits."""
    own = {each.result: each for each in flow.blocks[loop.header].instructions if each.opcode == "add"}
    waiting, seen = [name for name in own if name], set[str]()
    while waiting:
        name = waiting.pop()
        seen.add(name)
        for user in flow.users.get(name, []):
            if any(user is each for each in flow.blocks[loop.header].instructions):
                continue
            if user.opcode == "phi" and user.result and user.result not in seen:
                waiting.append(user.result)
            elif user.opcode not in ("phi", "trunc"):
                return False
    return True
