"""Stores to one element at the ends of both sides of an `if`, merged into one store after it [cond_if_else_store_replacement in tree-ssa-phiopt.cc].

GCC does so if each side stores once, and they join where nothing else leads. The stored value is then chosen without a
branch if it is already computed.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import bypass
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, phi_of


def merge_stores(routine: Routine) -> Routine:
    """Return `routine` with such stores merged."""
    flow = ControlFlow(routine)
    for block in routine.blocks:
        sides = [flow.blocks[each] for each in dict.fromkeys(block.successors)]
        if block.terminator.opcode != "br" or len(sides) != 2 or sides[0].successors != sides[1].successors:
            continue
        ends = sides[0].successors
        if len(ends) == 1 and sorted(flow.predecessors[ends[0]]) == sorted(each.label for each in sides):
            stores = [_only_store(each) for each in sides]
            if stores[0] and stores[1] and _address(flow, stores[0]) == _address(flow, stores[1]):
                return merge_stores(_merged(routine, flow, sides, (stores[0], stores[1])))
    return routine


def _only_store(block: BasicBlock) -> Instruction | None:
    """The store that a block ends with, if it has no other and no call."""
    writes = [each for each in block.instructions if each.opcode == "store" or each.is_call]
    last = block.instructions[-2:-1]
    return writes[0] if len(writes) == 1 and last == (writes[0],) and writes[0].opcode == "store" else None


def _address(flow: ControlFlow, store: Instruction) -> tuple[str, ...]:
    """What is equal for two stores to the same element: the type, and how the address is computed."""
    made = flow.instruction(store.operands[-1])
    kind = store.text.split()[1]
    return (
        (kind, made.text)
        if made is not None and made.opcode == "getelementptr"
        else (kind, store.operands[-1])
    )


def _merged(
    routine: Routine, flow: ControlFlow, sides: list[BasicBlock], stores: tuple[Instruction, Instruction]
) -> Routine:
    blocks = {each.label: each for each in routine.blocks}
    (end,) = sides[0].successors
    kind, name = stores[0].text.split()[1], f"%{end}.stored"
    arms = []
    for side, store in zip(sides, stores, strict=True):
        gone = [store]
        made = flow.instruction(store.operands[-1])
        if made is not None and made in side.instructions and flow.users[store.operands[-1]] == [store]:
            gone.append(made)
        blocks[side.label] = replace(
            side, instructions=tuple(each for each in side.instructions if each not in gone)
        )
        arms.append((store.operands[0], side.label))
    phi = phi_of(name, kind, arms, stores[0])
    pointer = stores[0].operands[-1]
    address = flow.instruction(pointer)
    if address is not None:  # its operands are the same on both sides, and so available after them
        address = replace(address, result=f"{name}.at")
        pointer = f"{name}.at"
    text = stores[0].text.replace(f"store {kind} {stores[0].operands[0]},", f"store {kind} {name},")
    text = text.replace(f"ptr {stores[0].operands[-1]}", f"ptr {pointer}")
    store = replace(stores[0], text=text, operands=(name, pointer))
    phis = [each for each in blocks[end].instructions if each.opcode == "phi"]
    behind = blocks[end].instructions[len(phis) :]
    made_there = () if address is None else (address,)
    blocks[end] = replace(blocks[end], instructions=(phi, *phis, *made_there, store, *behind))
    for side in sides:
        if len(blocks[side.label].instructions) == 1 and len(flow.predecessors[side.label]) > 1:
            bypass(blocks, flow.predecessors[side.label], side.label, end)
            break
    return replace(routine, blocks=tuple(blocks.values()))
