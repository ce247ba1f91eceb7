"""Partial redundancies: an operation that changes nothing on one way to it is done on the other ways alone.

Of `s + (v if v > t else 0)` one way has s already, so GCC makes `if v > t: s = s + v` of it, with a branch, where LLVM chooses between v
and 0 and adds [do_pre_regular_insertion in tree-ssa-pre.cc of GCC 12]. What phiopt has made of a choice before is none any more:
minimum, maximum, absolute value, and a flag, be it shifted.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from bfsim.kernel.ir_text import BasicBlock, Instruction, Routine, arms_of
from bfsim.kernel.loops import ControlFlow
from bfsim.kernel.lowering.if_conversion import ConversionKind, IfConversion
from bfsim.kernel.profile import GCC_O2

NEUTRAL = {
    "add": "0",
    "sub": "0",
    "or": "0",
    "xor": "0",
    "shl": "0",
    "lshr": "0",
    "ashr": "0",
    "mul": "1",
    "and": "-1",
}
"""On the right of these nothing is changed."""
COMMUTATIVE = ("add", "or", "xor", "mul", "and")
ABSORBING = {"mul": "0", "and": "0"}
"""With these nothing else counts."""
CASTS = ("zext", "sext", "trunc")


def without_partial_redundancies(routine: Routine) -> Routine:
    """Return `routine` with such operations on the ways that need them; one makes others such."""
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
    """An operation in the block `label`. `values`: what it gives, by the blocks from which that is known; the others have to do `rows`."""

    label: str
    operation: Instruction
    values: dict[str, str]
    rows: dict[str, list[Instruction]]


def _found(flow: ControlFlow, block: BasicBlock, converted: set[str | None]) -> _Redundancy | None:
    """Return the first redundancy in a block, which is no loop's header, and not what loops are left for (`Rule.ADDED_FLAGS`).

    `converted`: choices of which phiopt has made an operation, or a flag.
    """
    label, before = block.label, flow.predecessors[block.label]
    phis = [each for each in block.instructions if each.opcode == "phi"]
    if len(before) < 2 or not phis or any(label in flow.dominators[each] for each in before):
        return None
    if not all(flow.blocks[each].terminator.opcode == "br" for each in before):
        return None
    if any(_loops(flow, each) != _loops(flow, label) for each in before):
        return None
    choices = {each.result for each in phis} - converted
    for each in block.instructions:
        if each.opcode in NEUTRAL and len(each.operands) == 2:
            values, rows = dict[str, str](), dict[str, list[Instruction]]()
            for source in before:
                made = _on_way(flow, block, each, source)
                value = _value(each.opcode, made[-1].operands) if made else None
                if value is None:
                    rows[source] = made
                elif all(value != row.result for row in made):  # else it is to be converted there first
                    values[source] = value
            is_known = len(values) + len(rows) == len(before)
            if values and is_known and all(rows.values()) and rows and _chooses(flow, each, choices):
                return _Redundancy(label, each, values, rows)
    return None


def _loops(flow: ControlFlow, label: str) -> set[str]:
    """The loops around a block, by their headers."""
    return {loop.header for loop in flow.loops_of(label)}


def _chooses(flow: ControlFlow, each: Instruction, choices: set[str | None]) -> bool:
    """Whether an operand is chosen, perhaps in another width."""
    return any(_root(flow, operand) in choices for operand in each.operands)


def _root(flow: ControlFlow, value: str) -> str:
    each = flow.instruction(value)
    while each is not None and each.opcode in CASTS:
        value = each.operands[0]
        each = flow.instruction(value)
    return value


def _on_way(flow: ControlFlow, block: BasicBlock, each: Instruction, source: str) -> list[Instruction]:
    """Return what an operation is on the way from `source`, behind the conversions that it needs there; nothing if it needs more."""
    rows, text = list[Instruction](), each.text
    operands = []
    for operand in each.operands:
        value = _operand_on_way(flow, block, operand, source, rows)
        if value is None:
            return []
        text = _with(text, operand, value)
        operands.append(value)
    made = replace(each, result=f"{each.result}.{source}", text=text, operands=tuple(operands))
    return [*rows, made]


def _operand_on_way(
    flow: ControlFlow, block: BasicBlock, operand: str, source: str, rows: list[Instruction]
) -> str | None:
    """Return an operand on a way, None if it is more than a choice or a conversion of one."""
    label, made = flow.defined.get(operand, ("", None))
    if label != block.label or made is None:
        return operand
    if made.opcode == "phi":
        return arms_of(made)[source]
    if made.opcode not in CASTS:
        return None
    value = _operand_on_way(flow, block, made.operands[0], source, rows)
    if value is None or _is_number(value):
        return _converted(made, value)
    name = f"{made.result}.{source}"
    rows.append(replace(made, result=name, text=_with(made.text, made.operands[0], value), operands=(value,)))
    return name


def _converted(cast: Instruction, value: str | None) -> str | None:
    """Return a number in another width: 0 and small ones are the same."""
    if value is None:
        return None
    return value if 0 <= int(value) < 1 << 7 else None


def _is_number(value: str) -> bool:
    return value.lstrip("-").isdigit()


def _value(opcode: str, operands: tuple[str, ...]) -> str | None:
    """Return what an operation gives without being done, None if it has to be."""
    left, right = operands
    if _is_number(left) and _is_number(right):
        return None  # another number, which takes a register there: to add it behind, as it was, is nearer to GCC's code
    sides = [(left, right), (right, left)] if opcode in COMMUTATIVE else [(left, right)]
    for kept, other in sides:
        if other == NEUTRAL[opcode]:
            return kept
        if other == ABSORBING.get(opcode):
            return other
    return None


def _with(text: str, name: str, value: str) -> str:
    """Return the text of an instruction with another operand in the place of one."""
    return re.sub(rf"{re.escape(name)}(?![\w.$-])", value, text) if name.startswith("%") else text


def _moved(routine: Routine, flow: ControlFlow, found: _Redundancy) -> Routine:
    """Do an operation where it is needed, and choose between what there is behind it."""
    blocks = {each.label: each for each in routine.blocks}
    label, values = found.label, dict(found.values)
    for source, rows in found.rows.items():
        home = source
        if flow.blocks[source].successors != (label,):
            home = f"{label}.from.{source}"
            _split_edge(blocks, source, home, label, rows[-1])
        *before, last = blocks[home].instructions
        blocks[home] = replace(blocks[home], instructions=(*before, *rows, last))
        values[home] = rows[-1].result or ""
    kind = f"i{found.operation.bits}"
    arms = ", ".join(f"[ {value}, %{source} ]" for source, value in values.items())
    phi = replace(found.operation, opcode="phi", text=f"phi {kind} {arms}", operands=tuple(values.values()))
    rest = [each for each in blocks[label].instructions if each is not found.operation]
    blocks[label] = replace(blocks[label], instructions=(phi, *rest))
    for source in found.values:
        _without_empty(blocks, flow, source, label)
    return _without_unused(replace(routine, blocks=tuple(blocks.values())))


def _split_edge(
    blocks: dict[str, BasicBlock], source: str, between: str, label: str, like: Instruction
) -> None:
    """Put a block on the way from `source` to `label`."""
    jump = replace(
        like, result=None, opcode="br", text=f"br label %{label}", operands=(), weights=(), hint=""
    )
    after = {each: blocks.pop(each) for each in list(blocks)[list(blocks).index(label) :]}
    blocks[between] = BasicBlock(between, (jump,))
    blocks |= after
    _redirect(blocks, source, label, between)
    _rename_arm(blocks, label, source, between)


def _redirect(blocks: dict[str, BasicBlock], source: str, old: str, new: str) -> None:
    *rows, last = blocks[source].instructions
    jump = replace(last, text=_with(last.text, f"%{old}", f"%{new}"))
    blocks[source] = replace(blocks[source], instructions=(*rows, jump))


def _rename_arm(blocks: dict[str, BasicBlock], label: str, old: str, new: str) -> None:
    rows = [
        replace(each, text=_with(each.text, f"%{old}", f"%{new}")) if each.opcode == "phi" else each
        for each in blocks[label].instructions
    ]
    blocks[label] = replace(blocks[label], instructions=tuple(rows))


def _without_empty(blocks: dict[str, BasicBlock], flow: ControlFlow, empty: str, label: str) -> None:
    """Take out a block that only goes on to `label`, if the one before it does not lead there, too."""
    before = flow.predecessors[empty]
    if len(blocks[empty].instructions) > 1 or blocks[empty].enters or len(before) != 1:
        return
    (source,) = before
    if label in blocks[source].successors or blocks[source].terminator.opcode != "br":
        return
    _redirect(blocks, source, empty, label)
    _rename_arm(blocks, label, empty, source)
    del blocks[empty]


def _without_unused(routine: Routine) -> Routine:
    """Take out choices and conversions that nothing uses any more."""
    users = ControlFlow(routine).users
    removed = [
        each
        for block in routine.blocks
        for each in block.instructions
        if each.opcode in ("phi", *CASTS) and not users.get(each.result or "")
    ]
    if not removed:
        return routine
    blocks = tuple(
        replace(
            block, instructions=tuple(row for row in block.instructions if not any(row is x for x in removed))
        )
        for block in routine.blocks
    )
    return _without_unused(replace(routine, blocks=blocks))
