"""Code hoisting: what every path from a test computes is computed before it, if one side does so at once [do_hoist_insertion in tree-ssa-pre.cc of GCC 12].

In `if c & 1: c = (c >> 1) ^ 0xA001`, `else: c = c >> 1` the shift comes before the test; so does a step `i + 1` at the
end of an iteration, if one side uses it earlier. An operation with an operand from the block of the test itself stays
where it is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from bfsim.kernel.ir.control_flow import BEFORE_TESTS, ControlFlow
from bfsim.kernel.ir.text import Instruction, Routine, renamed
from bfsim.kernel.ir.value_numbers import FLAGS, ValueNumbers

HOISTED = ("add", "sub", "mul", "shl", "lshr", "ashr", "and", "or", "xor")


def with_hoisted_code(routine: Routine) -> Routine:
    """Return `routine` with such operations before the tests; what moves before one test may move on before the previous one."""
    for label in reversed(ControlFlow(routine).order):
        while (hoisted := _hoisted(ControlFlow(routine), label)) is not None:
            routine = hoisted
    return routine


@dataclass(frozen=True, slots=True)
class _Operation:
    """An operation, and the blocks that do it."""

    first: Instruction
    names: frozenset[str]
    homes: frozenset[str]


def _hoisted(flow: ControlFlow, label: str) -> Routine | None:
    """Return the routine with one operation moved before the test of a block; None if there is none to move."""
    ways = set(flow.blocks[label].successors)
    if len(ways) < 2 or any(label not in flow.dominators[way] or label == way for way in ways):
        return None
    for operation in _operations(flow):
        if _is_hoistable(flow, label, operation):
            return _moved(flow, label, operation)
    return None


def _operations(flow: ControlFlow) -> Iterator[_Operation]:
    """Operations of the routine; equal ones are one."""
    numbers, found = ValueNumbers(), dict[str, list[tuple[str, Instruction]]]()
    for label in flow.order:
        for each in flow.blocks[label].instructions:
            numbers.add(each)
            if each.opcode in HOISTED and each.result:
                found.setdefault(numbers.of(each.result), []).append((label, each))
    for same in found.values():
        names = frozenset(each.result or "" for _, each in same)
        yield _Operation(same[0][1], names, frozenset(label for label, _ in same))


def _is_hoistable(flow: ControlFlow, label: str, operation: _Operation) -> bool:
    """Whether every path from a block does an operation, one side of its test at once, and its operands are available before the block."""
    if any(home in flow.dominators[label] for home in operation.homes):
        return False
    for operand in operation.first.operands:
        home, made = flow.defined.get(operand, ("", None))
        if made is not None and (
            home not in flow.dominators[label] or (home == label and made.opcode != "phi")
        ):
            return False
    loop = flow.innermost(label)
    stays = [way for way in flow.blocks[label].successors if loop is None or way in loop.blocks]
    return any(_is_done_on(flow, label, way, operation) for way in stays) and label in _anticipating(
        flow, operation
    )


def _is_done_on(flow: ControlFlow, label: str, way: str, operation: _Operation) -> bool:
    """Whether one side of a test does an operation at once, also if it leads to a block to which another path brings the result.

    Then it is inserted on that side before [do_pre_regular_insertion].
    """
    others = [each for each in flow.predecessors[way] if each != label]
    brought = any((operation.homes - {way}) & flow.dominators[each] for each in others)
    return way in operation.homes and (brought or not others)


def _anticipating(flow: ControlFlow, operation: _Operation) -> set[str]:
    """Blocks from whose start every path to the end does an operation on the same operands."""
    changing = {flow.defined[each][0] for each in operation.first.operands if each in flow.defined}
    found = {each for each in flow.blocks if flow.blocks[each].successors or each in operation.homes}
    while gone := {
        each
        for each in found - operation.homes
        if any(way not in found or way in changing for way in flow.blocks[each].successors)
    }:
        found -= gone
    return found


def _text(flow: ControlFlow, operation: _Operation) -> str:
    """Return the text of an operation, with only those flags about its result that all its places have."""
    said = [{*flow.defined[name][1].text.split()} & FLAGS for name in operation.names]
    kept = frozenset.intersection(*map(frozenset, said))
    return " ".join(word for word in operation.first.text.split() if word not in FLAGS - kept)


def _moved(flow: ControlFlow, label: str, operation: _Operation) -> Routine:
    """Do an operation at the end of a block, and nowhere after it."""
    name = f"{operation.first.result}{BEFORE_TESTS}"
    while name in flow.defined:  # the same is done before other tests, too
        name += BEFORE_TESTS
    behind = {
        each.result or "": name
        for home in operation.homes
        if label in flow.dominators[home]
        for each in flow.blocks[home].instructions
        if each.result in operation.names
    }
    blocks = []
    for block in flow.routine.blocks:
        rows = [renamed(each, behind) for each in block.instructions if each.result not in behind]
        if block.label == label:
            rows.insert(-1, replace(operation.first, result=name, text=_text(flow, operation)))
        blocks.append(replace(block, instructions=tuple(rows)))
    return replace(flow.routine, blocks=tuple(blocks))
