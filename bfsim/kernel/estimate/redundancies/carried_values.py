"""Loads and addresses that the previous iteration has already made: partial redundancy elimination [tree-ssa-pre.cc of GCC 12].

`while parents[label] != label: label = parents[label]`: the value loaded for the test is the one that the next
iteration would load again. It is carried in a register, and the first one is loaded before the loop. If the index only
steps along, GCC leaves the loads as they are, for the vectoriser [inhibit_phi_insertion].
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.preheaders import with_preheader
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, arms_of, phi_of
from bfsim.kernel.ir.widths import BYTE


@dataclass(frozen=True, slots=True)
class CarriedValue:
    """A load or an address in the header of a loop; `index` is carried from iteration to iteration, `following` is its next value."""

    loop: Loop
    each: Instruction
    index: Instruction
    following: str


def carry_over(routine: Routine) -> Routine:
    """Return `routine` with such values as phis, loads before the addresses that they need."""
    flow = ControlFlow(routine)
    for opcode in ("load", "getelementptr"):
        for loop in flow.loops:
            for each in flow.blocks[loop.header].instructions:
                carried = _carried(flow, loop, each) if each.opcode == opcode else None
                if carried is not None:
                    return carry_over(_moved(flow, routine, carried))
    return routine


def _carried(flow: ControlFlow, loop: Loop, each: Instruction) -> CarriedValue | None:
    if set(flow.predecessors[loop.header]) != {flow.entering(loop), loop.latch}:
        return None
    address = _address(flow, each)
    index = flow.instruction(address.operands[-1]) if address is not None else None
    if address is None or index is None or index.opcode != "phi":
        return None
    if flow.defined[index.result or ""][0] != loop.header or _steps(flow, index, loop):
        return None
    if not all(flow.is_invariant(base, loop) for base in address.operands[:-1]):
        return None
    before = list(_until(flow.blocks[loop.header], each))
    if each.opcode == "load" and any(may_write(other, each) for other in before):
        return None
    following = _there(flow, each, arms_of(index)[loop.latch], loop.latch, loop.blocks)
    if following is None or (each.opcode != "load" and _first(flow, loop, each, index) is None):
        return None  # of phis that look like induction variables, only those of loads are made [insert_into_preds_of_block]
    return CarriedValue(loop, each, index, following)


def _first(flow: ControlFlow, loop: Loop, each: Instruction, index: Instruction) -> str | None:
    """The result of `each` in the first iteration, if it has been computed before the loop."""
    entering = flow.entering(loop)
    return _there(flow, each, arms_of(index)[entering], entering, frozenset(flow.blocks))


def _address(flow: ControlFlow, each: Instruction) -> Instruction | None:
    """The address that a load goes through, or the instruction itself."""
    found = flow.instruction(each.operands[0]) if each.opcode == "load" else each
    return found if found is not None and found.opcode == "getelementptr" else None


def _steps(flow: ControlFlow, index: Instruction, loop: Loop) -> bool:
    """Whether an index is an induction variable: a sum of itself and something invariant."""
    following = flow.instruction(arms_of(index)[loop.latch])
    if following is None or following.opcode not in ("add", "sub"):
        return following is None
    others = [each for each in following.operands if each != index.result]
    return len(others) == 1 and flow.is_invariant(others[0], loop)


def _there(flow: ControlFlow, each: Instruction, index: str, end: str, within: frozenset[str]) -> str | None:
    """The result of `each` for another index at the end of block `end`, if it has been computed by then."""
    address = _address(flow, each)
    assert address is not None
    for label in flow.order:
        if label not in within or label not in flow.dominators[end]:
            continue
        for other in flow.blocks[label].instructions:
            source = _address(flow, other) if other.opcode == each.opcode else None
            if source is None or source.operands != (*address.operands[:-1], index):
                continue
            if _kind(source) != _kind(address) or _kind(other) != _kind(each):
                continue
            if each.opcode != "load" or not _is_written(flow, other, label, end, within):
                return other.result
    return None


def _is_written(flow: ControlFlow, load: Instruction, label: str, end: str, within: frozenset[str]) -> bool:
    """Whether what was loaded in block `label` may have been overwritten at the end of block `end`."""
    rows = [*flow.blocks[label].instructions]
    rows = rows[next(number for number, row in enumerate(rows) if row is load) :]
    reached, waiting = set[str](), [label] if label != end else []
    while waiting:
        for way in flow.blocks[waiting.pop()].successors:
            if way in within and way not in reached and way not in flow.dominators[label]:
                reached.add(way)
                if way != end:
                    waiting.append(way)
    rows += [row for way in reached for row in flow.blocks[way].instructions]
    return any(may_write(row, load) for row in rows)


def may_write(row: Instruction, load: Instruction) -> bool:
    """Return whether an instruction may write what `load` loads: as in C, arrays of one width may overlap, and bytes overlap with anything."""
    return row.is_call or (row.opcode == "store" and (row.bits == load.bits or BYTE in (row.bits, load.bits)))


def _moved(flow: ControlFlow, routine: Routine, carried: CarriedValue) -> Routine:
    """Replace a load or an address by a phi, and compute it before the loop unless it is available there."""
    loop, each = carried.loop, carried.each
    entering = flow.entering(loop)
    first = _first(flow, loop, each, carried.index)
    made: list[Instruction] = []
    if first is None:
        if len(set(flow.blocks[entering].successors)) > 1:  # the loop need not be entered
            return with_preheader(routine, loop, entering)
        made = list(_before(flow, carried, arms_of(carried.index)[entering]))
        first = made[-1].result
    kind = "ptr" if each.opcode == "getelementptr" else _kind(each)
    arms = [(first or "", entering), (carried.following, loop.latch)]
    phi = phi_of(each.result or "", kind, arms, replace(each, location=""))
    alone = _address(flow, each) if each.opcode == "load" else None
    gone = [each, *([alone] if alone is not None and flow.users[alone.result or ""] == [each] else [])]
    blocks = []
    for block in routine.blocks:
        rows = [row for row in block.instructions if not any(row is other for other in gone)]
        if block.label == entering:
            rows[-1:-1] = made
        blocks.append(replace(block, instructions=(*[phi] * (block.label == loop.header), *rows)))
    return replace(routine, blocks=tuple(blocks))


def _before(flow: ControlFlow, carried: CarriedValue, index: str) -> Iterator[Instruction]:
    """What the first iteration loads, or its address."""
    address = _address(flow, carried.each)
    assert address is not None
    name = f"{carried.each.result}.first"
    made = replace(
        address,
        result=f"{name}.address" if address is not carried.each else name,
        text=address.text.removesuffix(f" {address.operands[-1]}") + f" {index}",
        operands=(*address.operands[:-1], index),
    )
    yield made
    if address is not carried.each:
        text = carried.each.text.replace(f" {address.result},", f" {made.result},")
        yield replace(carried.each, result=name, text=text, operands=(made.result or "",))


def _until(block: BasicBlock, last: Instruction) -> Iterator[Instruction]:
    for each in block.instructions:
        if each is last:
            return
        yield each


def _kind(each: Instruction) -> str:
    """The loaded type, or the type that an address points to, as LLVM writes it."""
    words = each.text.replace("inbounds ", "").replace("nuw ", "").replace("nusw ", "").split()
    return words[1].rstrip(",")
