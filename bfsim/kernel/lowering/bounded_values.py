"""Values that a test bounds by what they are made of: `(a >> 4) > 255` is to LLVM a test of `a`, and that of `a - 5` one, too.

C compilers see the test as it is written where they look for minima and maxima [minmax_replacement in tree-ssa-phiopt.cc of GCC 12].
So the value is computed before the test, not behind it where LLVM has moved it.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir_text import PHI_ARM, BasicBlock, Instruction, Routine, predicate
from bfsim.kernel.loops import ControlFlow

COMPARISON_OF = {"lshr": "u", "ashr": "s"}
"""Which comparison of what is shifted is one of the result, too: of unsigned numbers, or of signed ones."""


def bound_of(test: Instruction, value: Instruction) -> int | None:
    """Return what a comparison of `value`'s first operand with a constant bounds `value` to, or None if it does no such thing.

    The bound is the least number above those that are less.
    """
    if test.opcode != "icmp" or len(value.operands) != 2 or value.operands[0] != test.operands[0]:
        return None
    kind = predicate(test)
    numbers = all(each.lstrip("-").isdigit() for each in (test.operands[1], value.operands[1]))
    if kind in ("eq", "ne") or not numbers:
        return None
    least, by = int(test.operands[1]) + (kind[1:] in ("gt", "le")), int(value.operands[1])
    kinds = "su" if "samesign" in test.text else kind[0]
    if value.opcode == "add" and "nsw" in value.text and "s" in kinds:
        return least + by
    if COMPARISON_OF.get(value.opcode, "other") in kinds and not least & ((1 << by) - 1):
        return least >> by
    return None


def bound_values(routine: Routine) -> Routine:
    """Return `routine` with each value that a test bounds computed before it."""
    flow = ControlFlow(routine)
    for block in routine.blocks:
        if (found := _bounded(flow, block)) is not None:
            return bound_values(_moved(routine, *found))
    return routine


def _bounded(flow: ControlFlow, block: BasicBlock) -> tuple[Instruction, str, Instruction] | None:
    """A value that the test of a block bounds, the block behind it where it is computed, and the test."""
    test = flow.instruction(block.terminator.operands[0]) if len(set(block.successors)) == 2 else None
    if test is None or not any(each is test for each in block.instructions):
        return None
    for way in block.successors:
        others = {block.label, *block.successors} - {way}
        for each in flow.blocks[way].instructions if flow.predecessors[way] == [block.label] else ():
            bound = bound_of(test, each)
            if bound is not None and _is_chosen(flow, each, bound, others):
                return each, way, test
    return None


def _is_chosen(flow: ControlFlow, value: Instruction, bound: int, sources: set[str]) -> bool:
    """Whether ways from the test take the bound in place of the value."""
    names = {
        value.result,
        *(each.result for each in flow.users[value.result or ""] if each.opcode == "trunc"),
    }
    return any(
        each.opcode == "phi"
        and any(
            source[1:] in sources
            and arm.lstrip("-").isdigit()
            and any((int(arm) - near) % (1 << each.bits) == 0 for near in (bound - 1, bound))
            for arm, source in PHI_ARM.findall(each.text)
        )
        for name in names
        for each in flow.users[name or ""]
    )


def _moved(routine: Routine, value: Instruction, way: str, test: Instruction) -> Routine:
    blocks = []
    for block in routine.blocks:
        rows = [row for row in block.instructions if row is not value or block.label != way]
        place = next((number for number, row in enumerate(rows) if row is test), None)
        if place is not None:
            rows.insert(place, value)
        blocks.append(replace(block, instructions=tuple(rows)))
    return replace(routine, blocks=tuple(blocks))
