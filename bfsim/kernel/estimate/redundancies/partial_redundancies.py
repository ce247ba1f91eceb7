"""Partial redundancies: an operation that changes nothing on one path to it is done only on the other paths.

In `s + (v if v > t else 0)`, one path already has s, so GCC makes `if v > t: s = s + v` of it, with a branch, where
LLVM chooses between v and 0 and adds [do_pre_regular_insertion in tree-ssa-pre.cc of GCC 12]. The same goes for a
result that one path knows: `x - last`, if last is x there. A choice that phiopt has already replaced does not count:
minimum, maximum, absolute value, and a flag, even if shifted.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from bfsim.kernel.estimate.choices.if_conversion import ConversionKind, IfConversion
from bfsim.kernel.estimate.choices.known_values import KnownValues
from bfsim.kernel.estimate.conditions.number_tests import CONVERSIONS
from bfsim.kernel.ir.control_flow import EITHER, ControlFlow
from bfsim.kernel.ir.edges import come_to_from, going_to, put_between
from bfsim.kernel.ir.text import (
    COMMUTATIVE,
    BasicBlock,
    Instruction,
    Routine,
    arms_of,
    is_number,
    phi_of,
    renamed,
)
from bfsim.kernel.ir.unused import without_unused
from bfsim.kernel.profile import GCC_O2

NEUTRAL = {
    "add": "0", "sub": "0", "or": "0", "xor": "0", "shl": "0", "lshr": "0", "ashr": "0", "mul": "1", "and": "-1",
}  # fmt: skip
"""As right operands, these change nothing."""
ABSORBING = {"mul": "0", "and": "0"}
"""With these operands the other one does not matter."""
SAME = {"sub": "0", "xor": "0", "or": "", "and": ""}
"""The result for a value and itself; if empty, that value."""
SHIFTS = ("shl", "lshr", "ashr")
SAME_IN_ALL_WIDTHS = 1 << 7
"""Numbers from 0 to before it."""


def without_partial_redundancies(routine: Routine) -> Routine:
    """Return `routine` with such operations on the paths that need them; one may make others redundant."""
    while True:
        flow = ControlFlow(routine)
        made = {each.phi.result: each.kind for each in IfConversion(flow, GCC_O2).by_label.values()}
        converted = {each for each, kind in made.items() if kind is not ConversionKind.CHOICE}
        found = next(filter(None, (_found(flow, block, converted) for block in routine.blocks)), None)
        if found is None:
            return routine
        routine = _moved(routine, flow, found)


@dataclass(frozen=True, slots=True)
class _Redundancy:
    """An operation in the block `label`. `values`: its result, by the blocks from which that is known; the others have to do `rows`."""

    label: str
    operation: Instruction
    values: dict[str, str]
    rows: dict[str, list[Instruction]]


def _found(flow: ControlFlow, block: BasicBlock, converted: set[str | None]) -> _Redundancy | None:
    """Return the first redundancy in a block that is no loop's header, and no target of a loop with other exits (`Rule.ADDED_FLAGS`).

    `converted`: choices that phiopt has turned into an operation, or a flag.
    """
    label, before = block.label, flow.predecessors[block.label]
    choices = {each.result for each in block.instructions if each.opcode == "phi"} - converted
    if len(before) < 2 or not choices or any(label in flow.dominators[each] for each in before):
        return None
    if any(_loops(flow, each) != _loops(flow, label) and not _is_end(flow, each, label) for each in before):
        return None
    if any(flow.blocks[each].terminator.opcode != "br" for each in before):
        return None
    # outside loops, a value that a loop has loaded is carried there (`carried_values`)
    in_loop = flow.innermost(label) is not None
    for each in block.instructions:
        is_operation = each.opcode in NEUTRAL or (in_loop and _is_address(each))
        if is_operation and any(_root(flow, operand) in choices for operand in each.operands):
            found = _redundancy(flow, block, each)
            if found is not None:
                return found
    return next(filter(None, (_narrowing(flow, block, each, choices) for each in block.instructions)), None)


def _narrowing(
    flow: ControlFlow, block: BasicBlock, each: Instruction, choices: set[str | None]
) -> _Redundancy | None:
    """Return on which paths a choice that is stored as narrow, and also used as wide, is a number, which needs no narrowing."""
    wide = each.operands[0] if each.opcode == "trunc" else ""
    users = flow.users.get(each.result or "", ())
    if wide not in choices or len(flow.users[wide]) < 2 or any(user.opcode != "store" for user in users):
        return None
    phi = flow.instruction(wide)
    assert phi is not None
    bits = int(each.text.rsplit("i", 1)[1])
    known, values, rows = KnownValues(flow), dict[str, str](), dict[str, list[Instruction]]()
    for source, variable in arms_of(phi).items():
        value = known.number(variable, source, block.label) or variable
        if is_number(value):
            values[source] = str((int(value) + (1 << bits - 1)) % (1 << bits) - (1 << bits - 1))
        else:
            rows[source] = [replace(renamed(each, {wide: value}), result=f"{each.result}.{source}")]
    return _Redundancy(block.label, each, values, rows) if values else None


def _redundancy(flow: ControlFlow, block: BasicBlock, operation: Instruction) -> _Redundancy | None:
    """Return on which paths an operation is known and on which it has to be done; None unless there are both."""
    values, rows = dict[str, str](), dict[str, list[Instruction]]()
    for source in flow.predecessors[block.label]:
        made = _on_way(flow, block, operation, source)
        if made is None:
            return None
        value = _value(operation.opcode, made[-1].operands)
        if value is None:
            rows[source] = made
        elif any(value == row.result for row in made):
            return None  # it would have to be converted on this path
        else:
            values[source] = value
    return _Redundancy(block.label, operation, values, rows) if values and rows else None


def _is_address(each: Instruction) -> bool:
    """Whether it is the address of an element; for element 0 that is the array itself."""
    return each.opcode == "getelementptr" and len(each.operands) == 2


def _loops(flow: ControlFlow, label: str) -> set[str]:
    """The loops around a block, by their headers."""
    return {loop.header for loop in flow.loops_of(label)}


def _is_end(flow: ControlFlow, label: str, behind: str) -> bool:
    """Whether a block is the only exit of a loop among those around the block after it."""
    loop = flow.innermost(label)
    return (
        loop is not None
        and flow.exits(loop) == [label]
        and {each.header for each in flow.loops_of(label)} - {loop.header} == _loops(flow, behind)
    )


def _root(flow: ControlFlow, value: str) -> str:
    each = flow.instruction(value)
    while each is not None and each.opcode in CONVERSIONS:
        value = each.operands[0]
        each = flow.instruction(value)
    return value


def _on_way(flow: ControlFlow, block: BasicBlock, each: Instruction, source: str) -> list[Instruction] | None:
    """Return an operation as it is on the edge from `source`, after the conversions that it needs there; None if it needs more."""
    rows, text = list[Instruction](), each.text
    operands = []
    for operand in each.operands:
        value = _operand_on_way(flow, block, operand, source, rows)
        if value is None:
            return None
        text = _with(text, operand, value)
        operands.append(value)
    made = replace(each, result=f"{each.result}.{source}", text=text, operands=tuple(operands))
    return [*rows, made]


def _operand_on_way(
    flow: ControlFlow, block: BasicBlock, operand: str, source: str, rows: list[Instruction]
) -> str | None:
    """Return an operand on an edge; None if it is more than a choice or a conversion of one."""
    label, made = flow.defined.get(operand, ("", None))
    if label != block.label or made is None:
        return operand
    if made.opcode == "phi":
        return arms_of(made)[source]
    if made.opcode not in CONVERSIONS:
        return None
    value = _operand_on_way(flow, block, made.operands[0], source, rows)
    if value is None or (is_number(value) and not 0 <= int(value) < SAME_IN_ALL_WIDTHS):
        return None
    if is_number(value):
        return value
    name = f"{made.result}.{source}"
    rows.append(replace(made, result=name, text=_with(made.text, made.operands[0], value), operands=(value,)))
    return name


def _value(opcode: str, operands: tuple[str, ...]) -> str | None:
    """Return the result of an operation if it is known without doing it, else None."""
    left, right = operands
    if opcode == "getelementptr":
        return left if right == "0" else None
    if left == "0" and opcode in SHIFTS:
        return left
    if left == right and opcode in SAME:
        return SAME[opcode] or left
    absorbed = ABSORBING.get(opcode)
    if absorbed in (left, right):
        return absorbed
    if is_number(left) and is_number(right):
        # for an index, an offset; another number takes a register there: computing it after the choice, as before, is nearer to GCC's code
        return str(int(left) + int(right)) if opcode == "add" else None
    sides = [(left, right), (right, left)] if opcode in COMMUTATIVE else [(left, right)]
    for kept, other in sides:
        if other == NEUTRAL[opcode]:
            return kept
    return None


def _with(text: str, name: str, value: str) -> str:
    """Return the text of an instruction with one operand replaced."""
    return re.sub(rf"{re.escape(name)}(?![\w.$-])", value, text) if name.startswith("%") else text


def _type_of(operation: Instruction) -> str:
    """Return the type of an operation's result."""
    if _is_address(operation):
        return "ptr"
    return operation.text.split()[-1] if operation.opcode in CONVERSIONS else f"i{operation.bits}"


def _moved(routine: Routine, flow: ControlFlow, found: _Redundancy) -> Routine:
    """Do an operation where it is needed, and choose between the results after it."""
    blocks = {each.label: each for each in routine.blocks}
    label, values = found.label, dict(found.values)
    for source, rows in found.rows.items():
        home = source
        if flow.blocks[source].successors != (label,):
            home = f"{label}.from.{source}"
            while home in blocks:  # the other side of a test
                home += ".too"
            put_between(blocks, source, label, home)
        *before, last = blocks[home].instructions
        blocks[home] = replace(blocks[home], instructions=(*before, *rows, last))
        values[home] = rows[-1].result or ""
    kind = _type_of(found.operation)
    arms = ((value, source) for source, value in values.items())
    name = found.operation.result or ""
    chosen = f"{name}{EITHER}" if kind == "ptr" else name
    phi = phi_of(chosen, kind, arms, found.operation)
    rest = [each for each in blocks[label].instructions if each is not found.operation]
    blocks[label] = replace(blocks[label], instructions=(phi, *rest))
    if chosen != name:
        for each in blocks.values():
            blocks[each.label] = replace(
                each, instructions=tuple(renamed(row, {name: chosen}) for row in each.instructions)
            )
    for source in found.values:
        _without_empty(blocks, flow, source, label)
    return without_unused(replace(routine, blocks=tuple(blocks.values())), ("phi", *CONVERSIONS))


def _without_empty(blocks: dict[str, BasicBlock], flow: ControlFlow, empty: str, label: str) -> None:
    """Remove a block that only goes on to `label`, unless the one before it also leads there."""
    before = flow.predecessors[empty]
    is_empty = len(blocks[empty].instructions) == 1 and blocks[empty].successors == (label,)
    if not is_empty or blocks[empty].enters or len(before) != 1:
        return
    (source,) = before
    if label in blocks[source].successors or blocks[source].terminator.opcode != "br":
        return
    blocks[source] = going_to(blocks[source], empty, label)
    blocks[label] = come_to_from(blocks[label], empty, source)
    del blocks[empty]
