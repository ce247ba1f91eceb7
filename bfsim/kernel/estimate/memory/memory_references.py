"""Loads and stores of a loop that walk through arrays by a constant step, and which of them may meet [tree-data-ref.cc of GCC 12].

References to one array that are whole steps apart reach the same places some iterations later: they form a component.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

from bfsim.kernel.estimate.loops.scalar_evolution import Affine, ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction
from bfsim.kernel.ir.widths import BYTE


@dataclass(frozen=True, slots=True)
class Reference:
    """A load or a store in block `label`, of type `kind` (as LLVM writes it), through a pointer into the array `root`.

    `place`: the address in bytes, as a sum of the values that it is computed from. `step`: bytes that it gains per
    iteration; None if that is not constant.
    """

    each: Instruction
    label: str
    kind: str
    root: str
    place: Affine
    step: int | None

    @property
    def writes(self) -> bool:
        """Whether it is a store."""
        return self.each.opcode == "store"

    def ahead_of(self, other: Reference) -> int | None:
        """Return how many iterations later the other one reaches the same place; None if no whole number is known."""
        same = (self.kind, self.root, self.step) == (other.kind, other.root, other.step)
        apart = self.place.plus(other.place, -1)
        if not same or not self.step or apart.terms or apart.constant % self.step:
            return None
        return apart.constant // self.step


def references(flow: ControlFlow, evolution: ScalarEvolution, loop: Loop) -> list[Reference] | None:
    """Return the references of a loop, in order; None if it calls a kernel, which may load and store anything."""
    found = []
    for label in flow.inside(loop):
        for each in flow.blocks[label].instructions:
            if each.is_call:
                return None
            if each.opcode in ("load", "store"):
                kind, pointer = each.text.split()[1].rstrip(","), each.operands[-1]
                root, place = flow.root(pointer), evolution.affine(pointer)
                gain = evolution.increment(pointer, loop) if (root, 1) in place.terms else None
                step = None if gain is None or gain.symbolic else gain.constant
                found.append(Reference(each, label, kind, root, place, step))
    return found


def components(found: Sequence[Reference]) -> Iterator[list[Reference]]:
    """Yield the components of two or more references, in order, whose places no other reference can change in between."""
    bad = {id(each) for each in found if not each.step}
    together = {id(each): [each] for each in found}
    for one, other in combinations(found, 2):
        if one.ahead_of(other) is not None:
            merged = together[id(one)]
            if merged is not together[id(other)]:
                merged += together[id(other)]
                for each in merged:
                    together[id(each)] = merged
        elif (one.writes or other.writes) and _may_meet(one, other):
            bad |= {id(each) for each in (one, other) if not each.writes or (one.writes and other.writes)}
    kept = {id(rows): rows for rows in together.values()}.values()
    for rows in kept:
        if len(rows) > 1 and not any(id(each) in bad for each in rows):
            yield sorted(rows, key=found.index)


def _may_meet(one: Reference, other: Reference) -> bool:
    """Whether two references, the second after the first, may reach one place: as in C, except for a load after a store of another type.

    A store after a load comes before the load of the next iteration, and there GCC does not look at types
    [dr_may_alias_p].
    """
    if one.root == other.root:
        apart = one.place.plus(other.place, -1)
        return bool(apart.terms) or one.step != other.step or not one.step or one.kind != other.kind
    if one.writes and not other.writes:
        return one.kind == other.kind or f"i{BYTE}" in (one.kind, other.kind)
    return True
