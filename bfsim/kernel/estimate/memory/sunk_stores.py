"""Stores to one place on all paths to a block, joined into one store in front of it [sink_common_stores_to_bb in tree-ssa-sink.cc of GCC 12].

So `if v > 255: out[x] = 255`, `elif v < 0: out[x] = 0`, `else: out[x] = v` is a choice that is stored, and is treated
as if it were written so.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from bfsim.kernel.estimate.choices.narrow_choices import CHOSEN, SUNK
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import going_to
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, phi_of, renamed
from bfsim.kernel.ir.value_numbers import ValueNumbers
from bfsim.kernel.ir.widths import WORD


def with_sunk_stores(routine: Routine) -> Routine:
    """Return `routine` with a block in front of each such block that chooses the value and stores it."""
    while True:
        flow = ControlFlow(routine)
        numbers = ValueNumbers()
        for each in (row for label in flow.order for row in flow.blocks[label].instructions):
            numbers.add(each)
        found = next(
            ((block, stores) for block in routine.blocks if (stores := _stores(flow, numbers, block))), None
        )
        if found is None:
            return routine
        routine = _sunk(flow, *found)


def _stores(flow: ControlFlow, numbers: ValueNumbers, block: BasicBlock) -> list[Instruction]:
    """The last store of each predecessor, if they all end with it and it goes to one place."""
    sources = [flow.blocks[each] for each in flow.predecessors[block.label]]
    ends = all(len(each.successors) == 1 for each in sources)
    if len(sources) < 2 or not ends or any(loop.header == block.label for loop in flow.loops):
        return []
    stores = [_last_store(each) for each in sources]
    found = [each for each in stores if each is not None]
    if len(found) < len(sources) or len({_kind(each) for each in found}) > 1:
        return []
    places = {numbers.of(each.operands[1]) for each in found}
    return found if len(places) == 1 else []


def _last_store(block: BasicBlock) -> Instruction | None:
    """The store of a block that is its last access."""
    accesses = [each for each in block.instructions if each.opcode in ("load", "store") or each.is_call]
    return accesses[-1] if accesses and accesses[-1].opcode == "store" else None


def _kind(store: Instruction) -> str:
    return store.text.split()[1]


def _sunk(flow: ControlFlow, block: BasicBlock, stores: Sequence[Instruction]) -> Routine:
    """Return the routine with one store in front of `block`, of words if only their narrow parts are stored."""
    sources = flow.predecessors[block.label]
    label, first = f"{CHOSEN}.{block.label}", replace(stores[0], location="")  # it belongs to no single line
    wide = [_wide(flow, each.operands[0]) for each in stores]
    are_wide = all(each is not None for each in wide)
    values = tuple(each or "" for each in wide) if are_wide else tuple(each.operands[0] for each in stores)
    kind = f"i{WORD}" if are_wide else _kind(first)
    value = f"%{label}{SUNK}"
    rows = [each for each in block.instructions if each.opcode == "phi"]
    rows.append(phi_of(value, kind, zip(values, sources, strict=True), stores[0]))
    if are_wide:
        text = f"trunc i{WORD} {value} to {_kind(first)}"
        rows.append(replace(first, result=f"{value}.part", opcode="trunc", text=text, operands=(value,)))
    stored, place = rows[-1].result or "", first.operands[1]
    address = _address(flow, place, block.label, {})
    if address:
        rows += (replace(each, location="") for each in address.values())
        place = address[place].result or ""
    text = first.text.replace(f" {first.operands[0]},", f" {stored},").replace(
        f" {first.operands[1]},", f" {place},"
    )
    jump = f"br label %{block.label}"
    rows.append(replace(first, text=text, operands=(stored, place)))
    rows.append(replace(flow.blocks[sources[0]].terminator, text=jump, operands=(), weights=(), hint=""))
    return replace(
        flow.routine, blocks=tuple(_around(flow, block, sources, stores, BasicBlock(label, tuple(rows))))
    )


def _wide(flow: ControlFlow, value: str) -> str | None:
    """The word whose lower part a value is; also for a number."""
    each = flow.instruction(value)
    is_part = each is not None and each.opcode == "trunc" and each.text.startswith(f"trunc i{WORD} ")
    return each.operands[0] if each is not None and is_part else None


def _address(
    flow: ControlFlow, place: str, label: str, rows: dict[str, Instruction]
) -> dict[str, Instruction]:
    """The instructions that compute an address and are not available on all paths before block `label`, repeated, by their old names."""
    each = flow.instruction(place)
    if each is None or place in rows or flow.defined[place][0] in flow.dominators[label]:
        return rows
    for operand in each.operands:
        _address(flow, operand, label, rows)
    names = {old: row.result or "" for old, row in rows.items()}
    rows[place] = replace(renamed(each, names), result=f"{place}.{CHOSEN}.{label}")
    return rows


def _around(
    flow: ControlFlow,
    block: BasicBlock,
    sources: Sequence[str],
    stores: Sequence[Instruction],
    between: BasicBlock,
) -> Iterator[BasicBlock]:
    """The blocks of the routine with `between` in front of `block`, without the stores and what is computed only for them."""
    kept = {name for row in between.instructions for name in row.operands}
    for each in flow.routine.blocks:
        if each is block:
            yield between
            yield replace(block, instructions=tuple(row for row in block.instructions if row.opcode != "phi"))
        elif each.label in sources:
            rows = _without(flow, each, stores, kept)
            yield going_to(replace(each, instructions=rows), block.label, between.label)
        else:
            yield each


def _without(
    flow: ControlFlow, block: BasicBlock, stores: Sequence[Instruction], kept: set[str]
) -> tuple[Instruction, ...]:
    """The rows of a block without the stores and the rows that nothing else uses."""
    gone = {id(each) for each in stores}
    for row in reversed(block.instructions):
        if row.opcode in ("getelementptr", "trunc") and row.result not in kept:
            gone |= {id(row)} if all(id(user) in gone for user in flow.users[row.result or ""]) else set()
    return tuple(row for row in block.instructions if id(row) not in gone)
