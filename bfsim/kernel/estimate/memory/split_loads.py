"""Loads that LLVM has joined because they differ only in their addresses, split onto each path again.

LLVM turns the same load on several paths into one load after them, from a phi of addresses [foldPHIArgLoadIntoPHI]; if
only some paths from there need it, the load even sinks below. For elements of two arrays with one index, as in
`left[node] if low else right[node]`, it makes a phi of the arrays [SinkCommonCodeFromPredecessors], and for two elements
of one array, one of the indices [foldPHIArgGEPIntoPHI]. GCC leaves each load where the source has it. The kernel language
has no pointers, so a phi of addresses always comes from this.
"""

from __future__ import annotations

import re
from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.edges import put_between
from bfsim.kernel.ir.text import BasicBlock, Instruction, Routine, arms_of, each_arm, phi_of, renamed

INDICES = re.compile(r"\.pn\d*$")
"""Ends the name of a phi of the indices of two addresses that LLVM has joined."""


def split_loads(routine: Routine) -> Routine:
    """Return `routine` with a load at the end of each block that leads to a chosen address."""
    routine = _with_addresses_on_ways(routine)
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
        carried = _is_carried(flow, label, phi)
        if loads and ends_there and not carried and all(_may_move(flow, label, each) for each in loads):
            _split(blocks, label, phi, arms, loads)
    return replace(routine, blocks=tuple(blocks.values()))


def _with_addresses_on_ways(routine: Routine) -> Routine:
    """Return `routine` with phis of addresses in place of elements of a phi of arrays, or with a phi of indices."""
    while (found := _chosen_array(routine)) is not None:
        label, phi, users = found
        blocks = {each.label: each for each in routine.blocks}
        for source in {source for _, source in each_arm(phi) if len({*blocks[source].successors}) > 1}:
            put_between(blocks, source, label, f"{source}.to.{label}")
        for address in users:
            _compute_on_ways(blocks, label, phi.result or "", address)
        rows = tuple(each for each in blocks[label].instructions if each.result != phi.result)
        blocks[label] = replace(blocks[label], instructions=rows)
        routine = replace(routine, blocks=tuple(blocks.values()))
    return routine


def _chosen_array(routine: Routine) -> tuple[str, Instruction, list[Instruction]] | None:
    """Return the first such array with its block and the addresses of its elements, if their indices are known on each path."""
    flow = ControlFlow(routine)
    for label, block in flow.blocks.items():
        for phi in block.instructions:
            users = flow.users.get(phi.result or "", [])
            is_joined = phi.text.startswith("phi ptr") or INDICES.search(phi.result or "") is not None
            is_chosen = phi.opcode == "phi" and is_joined and users and not _is_carried(flow, label, phi)
            if is_chosen and all(_is_known_before(flow, label, phi, each) for each in users):
                return label, phi, users
    return None


def _is_carried(flow: ControlFlow, label: str, phi: Instruction) -> bool:
    """Whether a loop carries the phi of block `label` from iteration to iteration."""
    return any(label in flow.dominators[source] for _, source in each_arm(phi))


def _is_known_before(flow: ControlFlow, label: str, phi: Instruction, address: Instruction) -> bool:
    """Whether an address is of an element of a chosen array, with an index that is known before block `label`, or the other way round."""
    if address.opcode != "getelementptr" or phi.result not in address.operands:
        return False
    other = next((each for each in address.operands if each != phi.result), "")
    home, index = flow.defined.get(other, ("", None))
    return (
        index is None
        or (home != label and home in flow.dominators[label])
        or (home == label and index.opcode == "phi")
    )


def _compute_on_ways(blocks: dict[str, BasicBlock], label: str, array: str, address: Instruction) -> None:
    """Compute an address at the end of each block that leads to block `label`, and choose one of these there."""
    phis = {each.result: arms_of(each) for each in blocks[label].instructions if each.opcode == "phi"}
    merged = []
    for way, source in enumerate(phis[array]):
        names = {name: phis[name][source] for name in address.operands if name in phis}
        made = replace(renamed(address, names), result=f"{address.result}.{way}")
        *before, last = blocks[source].instructions
        blocks[source] = replace(blocks[source], instructions=(*before, made, last))
        merged.append((f"{address.result}.{way}", source))
    for name, block in blocks.items():
        rows = tuple(each for each in block.instructions if each is not address)
        blocks[name] = replace(block, instructions=rows)
    chosen = phi_of(address.result or "", "ptr", merged, address)
    blocks[label] = replace(blocks[label], instructions=(chosen, *blocks[label].instructions))


def _may_move(flow: ControlFlow, label: str, user: Instruction) -> bool:
    """Whether the user of an address chosen in block `label` is a load, and nothing is written before it."""
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
