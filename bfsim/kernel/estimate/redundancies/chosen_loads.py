"""Loads of a chosen element: if some paths to the choice have loaded theirs, the others load theirs, and the value is chosen, too.

After `if a[c + 1] > a[c]: c += 1`, each path has the value of `a[c]`, and the branch stays, because there are two
values to choose [do_pre_regular_insertion in tree-ssa-pre.cc of GCC 12]. If one side of a test has to load what the
other one loads at once, it is loaded before the test [do_hoist_insertion].
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.estimate.loops.scalar_evolution import Affine, ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow, pointee_nbytes
from bfsim.kernel.ir.edges import put_between
from bfsim.kernel.ir.text import Instruction, Routine, arms_of, phi_of, renamed, type_of

CHOSEN = ".chosen"


@dataclass(frozen=True, slots=True)
class _Chosen:
    """A load of an element whose index is chosen in its block. `values`: its value, by the blocks where that is already loaded."""

    label: str
    load: Instruction
    address: Instruction
    index: Instruction
    values: dict[str, str]
    beside: dict[str, str]
    """For each other block, the same load that the other side of its test makes at once, if it does."""


def with_chosen_loads(routine: Routine) -> Routine:
    """Return `routine` with such loads on the paths that need them."""
    while True:
        flow = ControlFlow(routine)
        found = next(_Loads(flow).chosen(), None)
        if found is None:
            return routine
        routine = _moved(flow, found)


class _Loads:
    """The loads of one routine, and their addresses."""

    def __init__(self, flow: ControlFlow) -> None:
        self.flow = flow
        self.evolution = ScalarEvolution(flow, InvariantCodeMotion(flow), evaluates=False)
        self.headers = {loop.header for loop in flow.loops}

    def chosen(self) -> Iterator[_Chosen]:
        """Yield those whose element is chosen, and already loaded on some paths."""
        for label in self.flow.order:
            before = self.flow.predecessors[label]
            if (
                len(before) < 2
                or label in self.headers
                or any(self.flow.blocks[each].terminator.opcode != "br" for each in before)
            ):
                continue
            for each in self.flow.blocks[label].instructions:
                if _changes(each):
                    break
                found = self._chosen(label, each) if each.opcode == "load" else None
                if found is not None and found.values:
                    yield found

    def _chosen(self, label: str, load: Instruction) -> _Chosen | None:
        address = self.flow.instruction(load.operands[0])
        index = (
            self.flow.instruction(address.operands[-1])
            if address is not None and address.opcode == "getelementptr"
            else None
        )
        if (
            address is None
            or index is None
            or index.opcode != "phi"
            or self.flow.defined[index.result or ""][0] != label
        ):
            return None
        base = self.flow.defined.get(address.operands[0], ("", None))[0]
        if base and base not in self.flow.dominators[label] - {label}:
            return None
        values, beside = dict[str, str](), dict[str, str]()
        for source, value in arms_of(index).items():
            at = self.evolution.affine(address.operands[0]).plus(
                self.evolution.affine(value), pointee_nbytes(address)
            )
            loaded = self._loaded(source, at, type_of(load))
            if loaded is not None:
                values[source] = loaded
            elif (other := self._beside(source, label, at, type_of(load))) is not None:
                beside[source] = other
        return _Chosen(label, load, address, index, values, beside)

    def _beside(self, source: str, label: str, at: Affine, kind: str) -> str | None:
        """What the side of a test that does not lead to `label` loads from an address at once."""
        others = [each for each in self.flow.blocks[source].successors if each != label]
        if len(others) != 1 or self.flow.predecessors[others[0]] != [source]:
            return None
        for each in self.flow.blocks[others[0]].instructions:
            if _changes(each):
                return None
            if self._loads(each, at, kind):
                return each.result
        return None

    def _loads(self, each: Instruction, at: Affine, kind: str) -> bool:
        """Whether an instruction loads what is at an address."""
        is_load = each.opcode == "load" and type_of(each) == kind
        return is_load and self._is_same(self.evolution.affine(each.operands[0]), at)

    def _loaded(self, label: str, at: Affine, kind: str) -> str | None:
        """The value loaded from an address on every path to the end of a block, if nothing in memory has changed since."""
        seen = set[str]()
        while label not in seen:  # a ring of blocks is never entered
            seen.add(label)
            for each in reversed(self.flow.blocks[label].instructions):
                if _changes(each):
                    return None
                if self._loads(each, at, kind):
                    return each.result
            before = self.flow.predecessors[label]
            if len(before) != 1:
                return None
            (label,) = before
        return None

    def _is_same(self, one: Affine, other: Affine) -> bool:
        """Whether two sums are equal, also by variables of a loop that are always equally far apart."""
        difference = one.plus(other, -1)
        if not difference.terms:
            return difference.constant == 0
        if len(difference.terms) != 2:
            return False
        (first, factor), (second, opposite) = difference.terms
        apart = self._apart(first, second)
        return factor == -opposite and apart is not None and factor * apart + difference.constant == 0

    def _apart(self, first: str, second: str) -> int | None:
        """By how much a variable of a loop always exceeds another one."""
        phis = [self.flow.instruction(each) for each in (first, second)]
        homes = {self.flow.defined[each][0] for each in (first, second) if each in self.flow.defined}
        if len(homes) != 1 or any(each is None or each.opcode != "phi" for each in phis):
            return None
        arms = [arms_of(each) for each in phis if each is not None]
        gaps = {
            self.evolution.affine(arms[0][way]).plus(self.evolution.affine(arms[1][way]), -1)
            for way in arms[0]
        }
        gap = gaps.pop()
        return None if gaps or gap.terms else gap.constant


def _changes(each: Instruction) -> bool:
    """Whether an instruction may change what is in memory."""
    return each.opcode == "store" or each.is_call


def _moved(flow: ControlFlow, found: _Chosen) -> Routine:
    """Load on the paths that need it, and choose the value."""
    blocks = {each.label: each for each in flow.routine.blocks}
    arms, names = list[tuple[str, str]](), dict[str, str]()
    for number, (source, value) in enumerate(arms_of(found.index).items()):
        if source in found.values:
            arms.append((found.values[source], source))
            continue
        address, name = (f"{each.result}{CHOSEN}{number}" for each in (found.address, found.load))
        rows = (
            replace(renamed(found.address, {found.index.result or "": value}), result=address),
            replace(renamed(found.load, {found.address.result or "": address}), result=name),
        )
        place = source
        if source in found.beside:
            names[found.beside[source]] = name
        elif len(set(blocks[source].successors)) > 1:
            place = f"{source}{CHOSEN}{number}"
            put_between(blocks, source, found.label, place)
        *own, end = blocks[place].instructions
        blocks[place] = replace(blocks[place], instructions=(*own, *rows, end))
        arms.append((name, place))
    phi = phi_of(found.load.result or "", type_of(found.load), arms, found.load)
    rest = tuple(each for each in blocks[found.label].instructions if each is not found.load)
    blocks[found.label] = replace(blocks[found.label], instructions=(phi, *rest))
    kept = (
        replace(
            each,
            instructions=tuple(renamed(row, names) for row in each.instructions if row.result not in names),
        )
        for each in blocks.values()
    )
    return replace(flow.routine, blocks=tuple(kept))
