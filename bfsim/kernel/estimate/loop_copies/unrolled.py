"""Loops with so few and so small iterations that a compiler unrolls them completely [try_unroll_loop_completely in tree-ssa-loop-ivcanon.cc].

GCC does so at -O2 if by its own estimate the code does not grow: two thirds of the iterations, without what becomes
constant in them, against one iteration. So it does for a loop that may end early, whose other exits were guessed to be
rare before [PRED_LOOP_EXIT]. LLVM is asked to unroll those and no others.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.estimate.loops.scalar_evolution import Affine, ScalarEvolution
from bfsim.kernel.estimate.memory.invariant_loads import hoist_loads
from bfsim.kernel.estimate.prediction.loop_guards import guards_of
from bfsim.kernel.estimate.prediction.predict import LOOP_GUARD
from bfsim.kernel.ir.control_flow import ControlFlow, Loop, pointee_nbytes
from bfsim.kernel.ir.reading import placed_rows, read_module
from bfsim.kernel.ir.text import LEAVES, TARGET, BasicBlock, Instruction, Routine, is_number
from bfsim.kernel.ir.writing import with_names, write_module

MOST_ITERATIONS = 8  # [max-completely-peel-times]
COUNTER = 1  # statement that steps what counts the iterations [create_canonical_iv]
FREE = ("phi", "zext", "sext", "trunc", "freeze")
LOOP_NOTE = ", !llvm.loop !"
GUARDED = (round(100 * (1 - LOOP_GUARD)), round(100 * LOOP_GUARD))
"""Weights of the edge to a loop in another one, and of the edge past it."""
FULL, DISABLED = "llvm.loop.unroll.full", "llvm.loop.unroll.disable"


def marked(text: str, *, guesses: bool) -> str | None:
    """Return the module `text` with a request to unroll each such loop, and one not to for all others; None if there is none.

    `guesses`: tests that lead to such loops are guessed to fail.
    """
    text = with_names(text)
    routines = [(routine, list(_loops(routine))) for routine in read_module(text)]
    wishes = {
        (routine.symbol, loop.latch): FULL if unrolls else DISABLED
        for routine, loops in routines
        for loop, unrolls in loops
    }
    if FULL not in wishes.values():
        return None
    if guesses:
        text = write_module(text, [_hinted(*each) for each in routines])
    rows, notes = list(_annotated(text, wishes)), len(text)  # numbers that no other metadata node has
    for number, wish in enumerate(wishes.values()):
        own = notes + 2 * number
        rows += [f"!{own} = distinct !{{!{own}, !{own + 1}}}", f'!{own + 1} = !{{!"{wish}"}}']
    return "\n".join(rows)


def _hinted(routine: Routine, loops: Sequence[tuple[Loop, bool]]) -> Routine:
    """Give a hint to each test that decides whether an unrolled loop is reached: GCC guesses before it unrolls."""
    flow, unrolled = ControlFlow(routine), {loop.latch for loop, unrolls in loops if unrolls}
    guards = dict(
        guard
        for around in flow.loops
        for loop in around.inner
        if loop.latch in unrolled
        for guard in guards_of(flow, loop, around)
    )
    guesses = {label: (way, GUARDED) for label, way in guards.items()}
    for loop in flow.loops:
        if loop.latch in unrolled:
            guesses |= {
                label: (_leaving(flow, loop, label), LEAVES)
                for label in flow.exits(loop)
                if label != loop.latch
            }
    return replace(routine, blocks=tuple(_guessed(each, guesses.get(each.label)) for each in routine.blocks))


def _leaving(flow: ControlFlow, loop: Loop, label: str) -> str:
    """The edge out of a loop from one of its blocks."""
    return next(way for way in flow.blocks[label].successors if way not in loop.blocks)


def _guessed(block: BasicBlock, guess: tuple[str, tuple[int, int]] | None) -> BasicBlock:
    """Return a block with the guess that its test seldom takes an edge, and how seldom, if there is no other guess."""
    *rows, end = block.instructions
    if guess is None or end.weights or end.opcode != "br":
        return block
    way, seldom = guess
    weights = seldom if block.successors[0] == way else seldom[::-1]
    return replace(block, instructions=(*rows, replace(end, weights=weights, hint="")))


def _annotated(text: str, wishes: dict[tuple[str, str], str]) -> Iterator[str]:
    numbers = {place: len(text) + 2 * number for number, place in enumerate(wishes)}
    for symbol, label, row in placed_rows(text):
        latch = row.startswith("  br ") and (symbol, label) in numbers
        yield f"{row.split(LOOP_NOTE)[0]}{LOOP_NOTE}{numbers[symbol, label]}" if latch else row


def _loops(routine: Routine) -> Iterator[tuple[Loop, bool]]:
    flow = ControlFlow(hoist_loads(routine))
    evolution = ScalarEvolution(flow, InvariantCodeMotion(flow))
    for loop in flow.loops:
        yield loop, not loop.inner and _shrinks(flow, evolution, loop)


def _shrinks(flow: ControlFlow, evolution: ScalarEvolution, loop: Loop) -> bool:
    inside = [each for label in flow.inside(loop) for each in flow.blocks[label].instructions]
    iterations = evolution.iterations(loop)
    if iterations is None or iterations > MOST_ITERATIONS or loop.latch not in flow.exits(loop):
        return False
    if any(each.is_call or each.is_division for each in inside):
        return False
    statements = _Statements(flow, evolution, loop)
    for each in inside:
        statements.count(each)
    return max(2 * iterations * statements.kept // 3, 1) <= statements.whole


class _Statements:
    """Statements that C has for one iteration of a loop [tree_estimate_loop_size].

    `kept` are those that each copy has; the others are of the counter alone, constants once the loop is unrolled.
    """

    def __init__(self, flow: ControlFlow, evolution: ScalarEvolution, loop: Loop) -> None:
        self.flow, self.evolution, self.loop = flow, evolution, loop
        self.kept = self.folded = 0
        self.places = set[tuple[str, ...]]()
        """Indices that are already summed and scaled, after the bytes of an element."""
        self.sets_constants = False
        """Whether a constant comes from an operation through which no counter is followed: GCC takes one statement less for it."""

    @property
    def whole(self) -> int:
        """Statements of an iteration, with those of an iteration counter and the one that is saved before the loop."""
        return self.kept + self.folded + COUNTER + self.sets_constants

    def count(self, each: Instruction) -> None:
        """Add an instruction; what does not change in the loop has left it."""
        fixed = each.result and self.evolution.code_motion.is_invariant(each.result, self.loop)
        if each.opcode in FREE or fixed or (each.opcode == "br" and not each.operands):
            return
        if each.opcode == "getelementptr":
            self._address(each)
        elif each.opcode == "br":
            test = self.flow.instruction(each.operands[0])
            if test is not None and not self._chooses(each, test):
                self._add(1, folds=self._are_constant(test.operands[:2]))
        elif each.opcode not in ("load", "store") and self._are_constant(each.operands):
            self._add(1, folds=True)
            self.sets_constants |= each.opcode != "icmp" and not self._is_constant(each.result or "")
        else:
            self._add(1, folds=False)

    def _chooses(self, branch: Instruction, test: Instruction) -> bool:
        """Whether a branch makes the minimum or maximum of what it compares: that is one statement."""
        behind = {
            way for each in TARGET.findall(branch.text) for way in self.flow.blocks[each[1:]].successors
        }
        return any(
            each.opcode == "phi" and set(each.operands) == set(test.operands[:2])
            for way in behind
            for each in self.flow.blocks[way].instructions
        )

    def _address(self, each: Instruction) -> None:
        """C sums indices first, in a separate operation, and then scales them."""
        base = self.flow.instruction(each.operands[0])
        summed = base is not None and base.opcode == "getelementptr"
        indices = [*(base.operands[1:] if base is not None and summed else ()), *each.operands[1:]]
        self._add(1, folds=False)
        nbytes = max(pointee_nbytes(one) for one in (each, *([base] if base is not None else [])))
        place = (str(nbytes), *indices)
        if place not in self.places:  # what is already computed is not computed again
            self.places.add(place)
            self._add(summed + (nbytes > 1), folds=self._are_constant(indices))

    def _add(self, number: int, *, folds: bool) -> None:
        self.kept += number * (not folds)
        self.folded += number * folds

    def _are_constant(self, values: Sequence[str]) -> bool:
        return all(self._is_constant(each) for each in values)

    def _is_constant(self, value: str) -> bool:
        """Whether a value is a sum of constants and of counters that start at constants."""
        for name, _ in self.evolution.affine(value).terms:
            gain = self._gain(name)
            start = self.evolution.first(name, self.loop)
            if gain is None or gain.terms or start is None or not is_number(start):
                return False
        return True

    def _gain(self, name: str) -> Affine | None:
        home = self.flow.defined.get(name)
        if home is None or home[0] != self.loop.header or home[1].opcode != "phi":
            return None
        return self.evolution.gain(name, self.loop)
