"""Unsigned narrow values, compared as such if one of them is made a word only for the comparison ["Unwiden" in match.pd of GCC 12].

So `if a[i] > most: most = a[i]` compares bytes and chooses between words if `most` is a byte, too: the chosen values
are not the compared ones, so phiopt sees no maximum. Later, a value is made a word once for all uses [pass_fre].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, Routine, predicate, renamed
from bfsim.kernel.ir.unused import without_unused

UNSIGNED = {"sgt": "ugt", "sge": "uge", "slt": "ult", "sle": "ule"}


def with_narrow_tests(routine: Routine) -> Routine:
    """Return `routine` with such comparisons, and without second extensions of a value."""
    flow = ControlFlow(routine)
    return _without_copies(_mapped(routine, lambda each: _narrowed(flow, each)))


def _narrowed(flow: ControlFlow, test: Instruction) -> Instruction:
    if test.opcode != "icmp" or predicate(test) not in UNSIGNED:
        return test
    words = [flow.instruction(each) for each in test.operands]
    found = [each for each in words if each is not None and each.opcode == "zext"]
    kinds = {each.text.split()[1] for each in found}
    single = any(len(flow.users[each.result or ""]) == 1 for each in found)
    if len(found) < 2 or len(kinds) > 1 or not single:
        return test
    (kind,), (left, right) = kinds, (each.operands[0] for each in found)
    text = f"icmp {UNSIGNED[predicate(test)]} {kind} {left}, {right}"
    return replace(test, text=text, operands=(left, right))


def _without_copies(routine: Routine) -> Routine:
    """Leave out extensions that only choices read if the same word exists already, and values that nothing reads."""
    flow = ControlFlow(routine)
    words = {
        each.text: (label, each.result or "")
        for label in reversed(flow.order)
        for each in flow.blocks[label].instructions
        if each.opcode == "zext"
    }
    same = dict[str, str]()
    for label in flow.order:
        for each in flow.blocks[label].instructions:
            users = flow.users.get(each.result or "", [])
            if each.opcode != "zext" or not users or any(user.opcode != "phi" for user in users):
                continue
            home, first = words[each.text]
            if first != each.result and home in flow.dominators[label]:
                same[each.result or ""] = first
    kept = _mapped(routine, lambda each: None if each.result in same else renamed(each, same))
    return without_unused(kept, ("zext", "getelementptr"))


def _mapped(routine: Routine, change: Callable[[Instruction], Instruction | None]) -> Routine:
    """Return `routine` with its instructions replaced, or left out if there is no replacement."""
    blocks = (
        replace(block, instructions=tuple(filter(None, map(change, block.instructions))))
        for block in routine.blocks
    )
    return replace(routine, blocks=tuple(blocks))
