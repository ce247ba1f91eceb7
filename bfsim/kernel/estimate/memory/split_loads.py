"""Loads that LLVM has made one, because they differ in their addresses only, are made on each way again.

LLVM turns the same load on several ways into one load behind them, from an address that the ways choose
[foldPHIArgLoadIntoPHI]; if only some ways from there need it, it even sinks below. GCC leaves each load where the source has it.
The kernel language has no pointers, so an address that is chosen always comes of that.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, each_arm, phi_of


def split_loads(routine: Routine) -> Routine:
    """Return `routine` with a load at the end of each block that leads to a chosen address."""
    flow = ControlFlow(routine)
    chosen = [
        (block.label, phi, flow.users.get(phi.result or "", []))
        for block in routine.blocks
        for phi in block.instructions
        if phi.text.startswith("phi ptr")
    ]
    blocks = {each.label: each for each in routine.blocks}
    for label, phi, loads in chosen:
        arms = each_arm(phi)
        ends_there = all(flow.blocks[source].successors == (label,) for _, source in arms)
        carried = any(label in flow.dominators[source] for _, source in arms)
        if loads and ends_there and not carried and all(_may_move(flow, label, each) for each in loads):
            _split(blocks, label, phi, arms, loads)
    return replace(routine, blocks=tuple(blocks.values()))


def _may_move(flow: ControlFlow, label: str, user: Instruction) -> bool:
    """Whether the user of an address that is chosen before block `label` is a load, and nothing is written before it."""
    if user.opcode != "load":
        return False
    home, _ = flow.defined[user.result or ""]
    between = flow.blocks_before([home] if home != label else [], {label, home})
    rows = [each for name in between - {home} for each in flow.blocks[name].instructions]
    own = flow.blocks[home].instructions
    rows += own[: next(number for number, each in enumerate(own) if each is user)]
    return not any(each.opcode == "store" or each.is_call for each in rows)


def _split(
    blocks: dict[str, BasicBlock],
    label: str,
    phi: Instruction,
    arms: list[tuple[str, str]],
    loads: list[Instruction],
) -> None:
    values = []
    for load in loads:
        merged = []
        for way, (address, source) in enumerate(arms):
            name = f"{load.result}.{way}"
            made = replace(
                load,
                result=name,
                text=load.text.replace(f"ptr {phi.result}", f"ptr {address}"),
                operands=(address,),
            )
            *before, last = blocks[source].instructions
            origin = next((each for each in before if each.result == address), last)
            made = replace(made, line=origin.line, location=origin.location)
            blocks[source] = replace(blocks[source], instructions=(*before, made, last))
            merged.append((name, source))
        kind = load.text.removeprefix("load ").split(",")[0]
        values.append(phi_of(load.result or "", kind, merged, load))
    for name, block in blocks.items():
        rows = [
            each for each in block.instructions if each is not phi and not any(each is load for load in loads)
        ]
        if name == label:
            rows = [*values, *rows]
        blocks[name] = replace(block, instructions=tuple(rows))
