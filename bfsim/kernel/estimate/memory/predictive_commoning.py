"""Predictive commoning: values that an earlier iteration has loaded or stored are carried in registers [tree-predcom.cc of GCC 12].

`a[i] - a[i - 1]` loads only a[i]; the other one was loaded an iteration before. With -O2 GCC does so without unrolling,
so values move from register to register at the end of each iteration: a loop in which two of them move is no hardware
loop.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.estimate.loops.scalar_evolution import Affine, ScalarEvolution
from bfsim.kernel.estimate.memory.invariant_loads import Hoisting
from bfsim.kernel.estimate.memory.memory_references import Reference, components, references
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.preheaders import with_preheader
from bfsim.kernel.ir.text import Instruction, Routine, arms_of, is_number, phi_of, renamed

ALONG = ".along."
"""In the names of carried values: narrow elements are kept as they were loaded, and extended where they are used."""
MOST_ITERATIONS = 4
"""At this distance nothing is carried any more [MAX_DISTANCE, with fewer than 16 registers]."""


@dataclass(frozen=True, slots=True)
class Chain:
    """`root`: the reference that reaches each place first; the `others` get there the given number of iterations later."""

    root: Reference
    others: tuple[tuple[Reference, int], ...]

    @property
    def length(self) -> int:
        """Iterations for which a value is carried."""
        return max(later for _, later in self.others)

    @property
    def value(self) -> str:
        """What the root has loaded, or stored."""
        each = self.root.each
        return each.operands[0] if self.root.writes else each.result or ""


def with_predictive_commoning(routine: Routine) -> Routine:
    """Return `routine` with such values of its innermost loops in phis."""
    for header in [loop.header for loop in ControlFlow(routine).loops if not loop.inner]:
        flow = ControlFlow(routine)
        loop = next(each for each in flow.loops if each.header == header)
        if set(flow.predecessors[header]) != {flow.entering(loop), loop.latch}:
            continue
        evolution = ScalarEvolution(flow, InvariantCodeMotion(flow))
        chains = [each for each in _chains(flow, evolution, loop) if _can_begin(flow, each.root, loop)]
        if chains and len(set(flow.blocks[flow.entering(loop)].successors)) > 1:
            routine = with_preheader(routine, loop, flow.entering(loop))
            flow = ControlFlow(routine)
            loop = next(each for each in flow.loops if each.header == header)
        if chains:
            routine = _carried(routine, flow, loop, chains)
    return routine


def _chains(flow: ControlFlow, evolution: ScalarEvolution, loop: Loop) -> Iterator[Chain]:
    """Yield the chains of a loop, except those whose values need not be loaded in the first iteration [prepare_initializers_chain]."""
    always = flow.always_run(loop)
    for rows in components(references(flow, evolution, loop) or []):
        if all(each.label in always for each in rows):
            later = [(each, rows[0].ahead_of(each) or 0) for each in rows]
            yield from _split(sorted(later, key=lambda pair: pair[1]))


def _split(rows: Sequence[tuple[Reference, int]]) -> Iterator[Chain]:
    """Split references, in the order in which they reach a place, at stores and where they are far apart [determine_roots_comp]."""
    starts = [0]
    for number, (each, later) in enumerate(rows):
        if number and (each.writes or later - rows[starts[-1]][1] >= MOST_ITERATIONS):
            starts.append(number)
    for first, end in zip(starts, [*starts[1:], len(rows)], strict=True):
        root, begin = rows[first]
        if end > first + 1:
            yield Chain(root, tuple((each, later - begin) for each, later in rows[first + 1 : end]))


def _can_begin(flow: ControlFlow, root: Reference, loop: Loop) -> bool:
    """Whether the start of the first iteration is known before the loop, as an index."""
    numbers = [root.place.constant, *(times for name, times in root.place.terms if name != root.root)]
    is_index = root.kind.startswith("i") and all(each % _size(root) == 0 for each in numbers)
    return is_index and all(_first(flow, name, loop) is not None for name, _ in root.place.terms)


def _size(reference: Reference) -> int:
    return int(reference.kind.removeprefix("i")) // 8


def _first(flow: ControlFlow, name: str, loop: Loop) -> str | None:
    """Return a value in the first iteration, None if that is not known before the loop."""
    if flow.is_invariant(name, loop):
        return name
    label, each = flow.defined[name]
    if label == loop.header and each.opcode == "phi":
        return arms_of(each)[flow.entering(loop)]
    return name if Hoisting(flow, loop).needed(each) is not None else None


def _leaving(flow: ControlFlow, loop: Loop, chains: Sequence[Chain]) -> list[Instruction]:
    """Return the invariant instructions that leave the loop because the starts of chains are computed from them."""
    hoisting, found = Hoisting(flow, loop), dict[int, Instruction]()
    for name in (name for chain in chains for name, _ in chain.root.place.terms):
        each = flow.instruction(name)
        if not flow.is_invariant(name, loop) and each is not None and each.opcode != "phi":
            found |= {id(needed): needed for needed in hoisting.needed(each) or []}
    return list(found.values())


def _carried(routine: Routine, flow: ControlFlow, loop: Loop, chains: Sequence[Chain]) -> Routine:
    """Replace the references after the roots of chains by phis, and put their first values before the loop."""
    made, phis, same = _leaving(flow, loop, chains), list[Instruction](), dict[str, str]()
    gone = {each.result for each in made}
    for chain in chains:
        name = f"%{loop.header}{ALONG}{len(phis)}"
        values = [*(f"{name}.{number}" for number in range(chain.length)), chain.value]
        firsts = _beginning(flow, loop, chain, name, made)
        for first, value, following in zip(firsts, values, values[1:], strict=False):
            phis.append(_phi(flow, loop, chain.root, (value, first, following)))
        same |= {each.each.result or "": values[chain.length - later] for each, later in chain.others}
    gone |= {*same}
    while chained := {old: same[new] for old, new in same.items() if new in same}:
        same |= chained
    blocks = []
    for block in routine.blocks:
        rows = [renamed(each, same) for each in block.instructions if each.result not in gone]
        if block.label == flow.entering(loop):
            rows[-1:-1] = made
        if block.label == loop.header:
            rows[:0] = [renamed(each, same) for each in phis]
        blocks.append(replace(block, instructions=tuple(rows)))
    return replace(routine, blocks=tuple(blocks))


def _phi(flow: ControlFlow, loop: Loop, root: Reference, names: tuple[str, str, str]) -> Instruction:
    """Return the phi of a value: its name, its first value, and its value in the next iteration."""
    name, first, following = names
    return phi_of(name, root.kind, [(first, flow.entering(loop)), (following, loop.latch)], root.each)


def _beginning(flow: ControlFlow, loop: Loop, chain: Chain, name: str, made: list[Instruction]) -> list[str]:
    """Add the instructions before the loop to `made`; return the first values of a chain's phis."""
    root, size = chain.root, _size(chain.root)

    def make(opcode: str, text: str, *operands: str) -> str:
        result = f"{name}.before.{len(made)}"
        made.append(
            replace(root.each, result=result, opcode=opcode, text=f"{opcode} {text}", operands=operands)
        )
        return result

    at = Affine(constant=root.place.constant)
    for term, times in root.place.terms:
        first = _first(flow, term, loop) or ""
        at = at.plus(Affine(constant=int(first)) if is_number(first) else Affine(((first, 1),)), times)
    base, index = root.root, ""
    for term, times in at.terms:
        if term != root.root:
            each = (
                term
                if times == size
                else make("mul", f"i32 {term}, {times // size}", term, f"{times // size}")
            )
            index = make("add", f"i32 {index}, {each}", index, each) if index else each
    if index:
        base = make("getelementptr", f"{root.kind}, ptr {base}, i32 {index}", base, index)
    firsts = []
    for iterations in range(-chain.length, 0):
        place = (at.constant + iterations * (root.step or 0)) // size
        address = (
            make("getelementptr", f"{root.kind}, ptr {base}, i32 {place}", base, f"{place}")
            if place
            else base
        )
        firsts.append(make("load", f"{root.kind}, ptr {address}, align {size}", address))
    return firsts
