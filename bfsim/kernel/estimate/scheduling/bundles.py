"""The accesses of a routine that share a bundle, and so take no extra cycle [bfin_gen_bundles in bfin.cc of GCC 12]."""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.kernel.estimate.registers.registers import Allocation
from bfsim.kernel.estimate.scheduling.block_schedule import BlockSchedule, is_kept
from bfsim.kernel.estimate.scheduling.local_registers import LocalRegisters
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.machine_code import MachineCode
from bfsim.kernel.ir.text import each_arm


def bundled(context: Context, code: MachineCode, allocation: Allocation) -> frozenset[tuple[str, int]]:
    """Return the blocks of such accesses, and their positions in them.

    Blocks between which no branch is left are scheduled as one, but not those that a test separated, because GCC may
    have kept it.
    """
    renews = {
        context.chosen(each, value): each.result or ""
        for block in context.flow.routine.blocks
        for each in block.instructions
        if each.opcode == "phi"
        for value, _ in each_arm(each)
    }
    found = set[tuple[str, int]]()
    for labels in _merged(context):
        places = [(label, number) for label in labels for number in range(len(code.of[label]))]
        places = _with_copies_in_front(places, code, allocation)
        registers = LocalRegisters(
            [code.of[label][number] for label, number in places],
            allocation.bank.get,
            lambda name: allocation.register.get(name, name),
            allocation.alive[labels[-1]],
        )
        pairs = BlockSchedule(registers, renews).paired()
        found |= {places[other] for wide, other in pairs if places[wide][0] == places[other][0]}
    return frozenset(found)


def _with_copies_in_front(
    places: list[tuple[str, int]], code: MachineCode, allocation: Allocation
) -> list[tuple[str, int]]:
    """Positions of instructions, with copies of old values before the instructions that compute the new ones: they are noted at the loop's end."""

    def register(name: str | None) -> str:
        return allocation.register.get(name or "", name or "")

    found = [place for place in places if not is_kept(code.of[place[0]][place[1]])]
    made = [register(code.of[label][number].result) for label, number in found]
    for label, number in reversed([place for place in places if place not in found]):
        old = register(code.of[label][number].uses[0][0])
        at = made.index(old) if old in made else 0
        found.insert(at, (label, number))
        made.insert(at, "")
    return found


def _merged(context: Context) -> Iterator[list[str]]:
    """Blocks that are one because no branch is left between them."""
    flow, gone, converted = context.flow, context.if_conversion.gone, context.if_conversion.by_label
    behind = dict[str, str]()
    for label, block in flow.blocks.items():
        ways = set(block.successors)
        if label in converted:
            ways = {flow.defined[converted[label].phi.result or ""][0]}
        if len(ways) == 1 and label not in gone:
            (way,) = ways
            if {*flow.predecessors[way]} - gone == {label}:
                behind[label] = way
    for label in flow.order:
        if label in gone or label in behind.values():
            continue
        labels = [label]
        while labels[-1] in behind:
            labels.append(behind[labels[-1]])
        yield labels
