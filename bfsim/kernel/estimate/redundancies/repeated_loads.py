"""Repeated loads: a load from the place of an earlier one, with nothing written since, gives the same value [pass_fre in tree-ssa-sccvn.cc of GCC 12].

GCC finds these first of all, so that `if a[i] > most: most = a[i]` chooses between two available values. LLVM gets
there only after it has joined the loads of both sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Routine, renamed
from bfsim.kernel.ir.value_numbers import ValueNumbers

Loaded = dict[tuple[str, str], str]
"""What was loaded last, by its kind and its place."""


def without_repeated_loads(routine: Routine) -> Routine:
    """Return `routine` with the first of such loads in place of the others."""
    flow = ControlFlow(routine)
    same = _repeated(flow)
    if not same:
        return routine
    blocks = []
    for block in routine.blocks:
        rows = [renamed(each, same) for each in block.instructions if each.result not in same]
        blocks.append(replace(block, instructions=tuple(rows)))
    return replace(routine, blocks=tuple(blocks))


def _repeated(flow: ControlFlow) -> dict[str, str]:
    """Return for each load the first one that all paths to it bring; a back edge brings none."""
    numbers = ValueNumbers()
    same: dict[str, str] = {}
    known: dict[str, Loaded] = {}
    for label in flow.order:
        here = _in_all([known.get(each, {}) for each in flow.predecessors[label]])
        for each in flow.blocks[label].instructions:
            numbers.add(each)
            if each.opcode == "store" or each.is_call:
                here = {}
            elif each.opcode == "load" and each.result:
                place = each.text.split(",")[0], numbers.of(each.operands[0])
                first = here.setdefault(place, each.result)
                if first != each.result:
                    same[each.result] = first
                    numbers.equate(each.result, first)
        known[label] = here
    return same


def _in_all(tables: Sequence[Loaded]) -> Loaded:
    first = tables[0] if tables else {}
    return {
        place: value for place, value in first.items() if all(each.get(place) == value for each in tables)
    }
