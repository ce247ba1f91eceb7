"""Loads whose value is already available on every path: partial redundancy elimination [tree-ssa-pre.cc of GCC 12].

`if a[j] < a[least]: least = j` in a loop: `a[least]` is `a[j]` if `least` was just set, and unchanged otherwise. The
value is carried in a separate register beside `least`, so there are two values to choose and the branch stays.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from bfsim.kernel.ir.control_flow import ControlFlow, Loop, pointee_nbytes
from bfsim.kernel.ir.edges import put_between
from bfsim.kernel.ir.loads_along import FOLLOWING
from bfsim.kernel.ir.preheaders import with_preheader
from bfsim.kernel.ir.text import Instruction, Routine, arms_of, phi_of, renamed
from bfsim.kernel.ir.unused import without_dead_code

AGAIN = ".again"  # in the name of an address that is only computed to be carried
ELSEWHERE = ".elsewhere"  # in the names of values loaded on the paths past a loop


@dataclass(frozen=True, slots=True)
class RedundantLoad:
    """A load at `address` in the header of a loop, whose value follows that of `index` along the arms of `merged`."""

    loop: Loop
    load: Instruction
    address: Instruction
    index: Instruction
    merged: Instruction
    values: dict[str, str]
    """For each arm of `merged`, by the label it comes from: the value that the load would give."""


def without_redundant_loads(routine: Routine) -> Routine:
    """Return `routine` with such loads before their loops."""
    flow = ControlFlow(routine)
    for loop in flow.loops:
        for each in flow.blocks[loop.header].instructions:
            carried = _carried(flow, loop, each)
            if carried is None:
                continue
            entering = flow.entering(loop)
            if len(set(flow.blocks[entering].successors)) > 1:  # the loop need not be entered
                return without_redundant_loads(with_preheader(routine, loop, entering))
            return without_redundant_loads(_moved(flow, routine, carried))
    return routine


def _carried(flow: ControlFlow, loop: Loop, load: Instruction) -> RedundantLoad | None:
    address = flow.instruction(load.operands[0]) if load.opcode == "load" else None
    if address is None or address.opcode != "getelementptr" or flow.users.get(address.result or "") != [load]:
        return None
    index = flow.instruction(address.operands[-1])
    if index is None or index.opcode != "phi" or flow.defined[index.result or ""][0] != loop.header:
        return None
    arms = arms_of(index)
    merged = flow.instruction(arms.get(loop.latch, ""))
    if set(arms) != {flow.entering(loop), loop.latch} or merged is None or merged.opcode != "phi":
        return None
    inside = [each for label in loop.blocks for each in flow.blocks[label].instructions]
    if any(each.opcode == "store" or each.is_call for each in inside):
        return None
    if not all(flow.is_invariant(each, loop) for each in address.operands[:-1]):
        return None
    values = {
        label: load.result if value == index.result else _loaded(flow, loop, load, value, label)
        for label, value in arms_of(merged).items()
    }
    known = {label: value for label, value in values.items() if value is not None}
    carried = RedundantLoad(loop, load, address, index, merged, known)
    return carried if len(known) == len(values) and _is_loaded_behind(flow, carried) else None


def _loaded(flow: ControlFlow, loop: Loop, load: Instruction, index: str, label: str) -> str | None:
    """The value at the same array's `index`, if it has been loaded on the path to the end of block `label`."""
    address = flow.defined[load.operands[0]][1]
    for before in flow.inside(loop):
        for each in flow.blocks[before].instructions if before in flow.dominators[label] else ():
            other = flow.instruction(each.operands[0]) if each.opcode == "load" else None
            if other is None or other.operands != (*address.operands[:-1], index):
                continue
            if pointee_nbytes(other) == pointee_nbytes(address) and _kind(each) == _kind(load):
                return each.result
    return None


def _kind(load: Instruction) -> str:
    """The loaded type, as LLVM writes it."""
    return load.text.split()[1].rstrip(",")


def _moved(flow: ControlFlow, routine: Routine, carried: RedundantLoad) -> Routine:
    """Load before the loop; in the loop, add a phi beside that of the index, and one beside each phi that merges it."""
    load, loop = carried.load, carried.loop
    first, following, address = (f"{load.result}{name}" for name in (".first", FOLLOWING, ".address"))
    entering = flow.entering(loop)
    arms = arms_of(carried.index)
    kind = _kind(load)
    start = replace(
        carried.address,
        result=address,
        text=carried.address.text.replace(f" {carried.index.result}", f" {arms[entering]}"),
        operands=(*carried.address.operands[:-1], arms[entering]),
    )
    before = replace(
        load,
        result=first,
        text=load.text.replace(f" {load.operands[0]},", f" {address},"),
        operands=(address,),
    )
    here = _phi(load, load.result or "", kind, {entering: first, loop.latch: following})
    merging = _phi(load, following, kind, carried.values)
    home = flow.defined[carried.merged.result or ""][0]
    blocks = []
    for block in routine.blocks:
        rows = [each for each in block.instructions if each is not load and each is not carried.address]
        if block.label == entering:
            rows[-1:-1] = [start, before]
        if block.label == home:
            rows.insert(0, merging)
        if block.label == loop.header:
            rows.insert(0, here)
        blocks.append(replace(block, instructions=tuple(rows)))
    routine = _without_loads_behind(replace(routine, blocks=tuple(blocks)), carried)
    return _with_addresses(ControlFlow(routine), routine, carried)


def _without_loads_behind(routine: Routine, carried: RedundantLoad) -> Routine:
    """Take the element that was chosen last as it comes out of the loop; other paths load it. Phis only of its index are removed."""
    flow = ControlFlow(routine)
    for address in _addresses_behind(flow, carried):
        home, load = _load_at(flow, address)
        index = flow.instruction(address.operands[-1])
        if load is not None and index is not None and flow.defined[index.result or ""][0] == home:
            values = _values_out(carried, index)
            if values is not None:
                return _without_loads_behind(_with_values_out(flow, address, load, values), carried)
    return without_dead_code(routine, kept=AGAIN)


def _values_out(carried: RedundantLoad, index: Instruction) -> dict[str, str] | None:
    """The values carried beside an index that is merged after the loop, by the loop's blocks; None if something else comes out of it."""
    along = {
        carried.merged.result: f"{carried.load.result}{FOLLOWING}",
        carried.index.result: carried.load.result or "",
    }
    inside = {label: value for label, value in arms_of(index).items() if label in carried.loop.blocks}
    return (
        {label: along[value] for label, value in inside.items()}
        if along.keys() >= {*inside.values()}
        else None
    )


def _with_values_out(
    flow: ControlFlow, address: Instruction, load: Instruction, values: Mapping[str, str]
) -> Routine:
    """Return the routine without a load after a loop. `values`: by the blocks from which they leave the loop."""
    blocks = {each.label: each for each in flow.routine.blocks}
    index, home = address.operands[-1], flow.defined[load.result or ""][0]
    arms = [(value, label) for label, value in values.items()]
    for number, (label, value) in enumerate(arms_of(flow.defined[index][1]).items()):
        if label in values:
            continue
        before, name = f"{home}{ELSEWHERE}{number}", f"{address.result}{ELSEWHERE}{number}"
        put_between(blocks, label, home, before)
        rows = (
            replace(renamed(address, {index: value}), result=name),
            replace(renamed(load, {address.result or "": name}), result=f"{load.result}{ELSEWHERE}{number}"),
        )
        blocks[before] = replace(blocks[before], instructions=(*rows, *blocks[before].instructions))
        arms.append((f"{load.result}{ELSEWHERE}{number}", before))
    phi = phi_of(load.result or "", _kind(load), arms, load)
    rest = tuple(each for each in blocks[home].instructions if each is not load)
    blocks[home] = replace(blocks[home], instructions=(phi, *rest))
    return replace(flow.routine, blocks=tuple(blocks.values()))


def _load_at(flow: ControlFlow, address: Instruction) -> tuple[str, Instruction | None]:
    """The load at an address in its own block before any store, and that block."""
    home = flow.defined[address.result or ""][0]
    for each in flow.blocks[home].instructions:
        if each.opcode == "store" or each.is_call:
            break
        if each.opcode == "load" and each.operands[0] == address.result:
            return home, each
    return home, None


def _with_addresses(flow: ControlFlow, routine: Routine, carried: RedundantLoad) -> Routine:
    """If the element is used after the loop, its address is carried: computed again on the paths that keep it."""
    kept = {label for label, value in carried.values.items() if value == carried.load.result}
    alone = all(len(set(flow.blocks[label].successors)) == 1 for label in kept)
    if not alone or not _is_wanted_behind(flow, carried):
        return routine
    name = f"{carried.load.result}{AGAIN}"
    again = {label: replace(carried.address, result=f"{name}.{label}") for label in kept}
    blocks = [
        replace(block, instructions=(again[block.label], *block.instructions))
        if block.label in kept
        else block
        for block in routine.blocks
    ]
    return replace(routine, blocks=tuple(blocks))


def _addresses_behind(flow: ControlFlow, carried: RedundantLoad) -> list[Instruction]:
    """Addresses of the element that was chosen last, computed after the loop."""
    array = carried.address.operands[:-1]
    chosen = [
        user.result
        for user in flow.users.get(carried.merged.result or "", [])
        if user.opcode == "phi" and flow.defined[user.result or ""][0] not in carried.loop.blocks
    ]
    users = (each for name in chosen for each in flow.users.get(name or "", []))
    return [each for each in users if each.opcode == "getelementptr" and each.operands[:-1] == array]


def _is_wanted_behind(flow: ControlFlow, carried: RedundantLoad) -> bool:
    return any(flow.users.get(each.result or "") for each in _addresses_behind(flow, carried))


def _is_loaded_behind(flow: ControlFlow, carried: RedundantLoad) -> bool:
    """Whether every path after the loop also loads the element that was chosen last.

    Otherwise the load is not sure to follow the choice of the index, as -O2 requires [compute_antic in tree-ssa-pre.cc;
    partial anticipation is for -O3].
    """
    loads = {
        flow.defined[load.result or ""][0]
        for address in _addresses_behind(flow, carried)
        for load in flow.users.get(address.result or "", [])
        if load.opcode == "load"
    }
    blocks = carried.loop.blocks
    ends = {way for label in blocks for way in flow.blocks[label].successors if way not in blocks}
    return all(loads & flow.post_dominators[way] for way in ends)


def _phi(load: Instruction, result: str, kind: str, arms: dict[str, str]) -> Instruction:
    return phi_of(result, kind, ((value, label) for label, value in arms.items()), replace(load, location=""))
