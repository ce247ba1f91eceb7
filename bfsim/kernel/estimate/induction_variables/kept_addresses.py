"""Where GCC steps a pointer that accesses share, and whether an iteration keeps what it was before.

The step is right behind the access that comes first in the order of their distances [split_address_groups and add_autoinc_candidates in
tree-ssa-loop-ivopts.cc of GCC 12], and both are one post-increment where that can be. Loads are made where their values are wanted,
though (`ir/expansion.py`), behind the step: then it is a sum of its own, and where other accesses come before, a copy of the pointer serves
them all, which keeps what it was.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.expansion import Expansion
from bfsim.kernel.ir.llvm_passes import OF_MEMORY
from bfsim.kernel.ir.text import Instruction, arms_of, is_number
from bfsim.kernel.ir.widths import BYTE


class Access(NamedTuple):
    """An access by the pointer of an induction variable: its block, and how many bytes from the pointer."""

    label: str
    instruction: Instruction
    offset: int


def stepping_access(accesses: Sequence[Access], loop: Loop, evolution: ScalarEvolution) -> Access:
    """Return the access behind which the pointer of all of them is stepped.

    That is the one at the lowest address, as far as GCC can tell. Where more than the array is unknown of the addresses, it takes negative
    distances for large ones: of bytes, if they are so with what the counter starts with; of wider elements always, since C's subscripts are
    made unsigned before they are multiplied. Accesses which seem that far away are a group of their own. Of the first accesses of both groups,
    it is the one that leaves more accesses at a distance of 0.
    """
    start, is_fixed = _start(accesses[0].instruction, loop, evolution)

    def is_far(access: Access) -> bool:
        is_whole = is_fixed or access.instruction.bits == BYTE
        return access.offset + (start if is_whole else 0) < 0

    groups = [each for each in accesses if not is_far(each)], [each for each in accesses if is_far(each)]
    firsts = [min(each, key=partial(_rank, loop, evolution.flow)) for each in groups if each]
    step = evolution.increment(accesses[0].instruction.operands[-1], loop)
    return min(
        firsts, key=lambda first: sum(map(bool, distances(accesses, first, step.constant if step else 0)))
    )


def _rank(loop: Loop, flow: ControlFlow, access: Access) -> tuple[int, int]:
    """Return what accesses of a group are in the order of: their addresses; of those to one, that in the first block is first, or else that in the last one.

    So GCC comes to the blocks [get_loop_body in cfgloop.cc].
    """
    is_first = access.label == loop.header
    return access.offset, -len(flow.order) if is_first else -flow.order.index(access.label)


def distances(accesses: Sequence[Access], stepping: Access, step: int) -> list[int]:
    """Return how many bytes from a pointer each of its accesses is. `step`: that of the pointer, made right behind one of them."""
    place = next(number for number, each in enumerate(accesses) if each is stepping)
    return [
        each.offset - stepping.offset - (step if number > place else 0)
        for number, each in enumerate(accesses)
    ]


def _start(access: Instruction, loop: Loop, evolution: ScalarEvolution) -> tuple[int, bool]:
    """Return the bytes that counters which start with constants add to a first address, and whether nothing else but the array does."""
    start, others, flow = 0, 0, evolution.flow
    for name, times in evolution.affine(access.operands[-1]).terms:
        each = flow.instruction(name)
        is_counter = each is not None and each.opcode == "phi" and flow.defined[name][0] == loop.header
        first = arms_of(each).get(flow.entering(loop), "") if each is not None and is_counter else ""
        if is_number(first):
            start += int(first) * times
        else:
            others += 1
    return start, others <= 1


def is_threaded(loop: Loop, flow: ControlFlow) -> bool:
    """Whether jumps of a loop were threaded behind ivopts, which saw accesses on one side of a test that every iteration makes now."""
    return any(OF_MEMORY in (each.result or "") for each in flow.blocks[loop.header].instructions)


def keeps_address(accesses: Sequence[Access], stepping: Access, loop: Loop, flow: ControlFlow) -> bool:
    """Whether a copy of the pointer of some accesses serves those up to the one behind which it is stepped."""
    label, load, _ = stepping
    rows = flow.blocks[label].instructions
    if load.opcode != "load" or load not in rows or is_threaded(loop, flow):
        return False
    place, expansion = rows.index(load), Expansion(flow, label)
    before = [each for where, each, _ in accesses if where == label and each in rows[:place]]
    loads = [each for each in (*before, load) if each.opcode == "load"]
    return bool(before) and any(expansion.place(each) > place for each in loads)
