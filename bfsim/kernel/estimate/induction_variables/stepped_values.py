"""Values that a loop steps along: in `a[i] = 100 - 3 * i`, each iteration subtracts 3 from the last value [tree-ssa-loop-ivopts.cc of GCC 12].

So the counter is not needed if nothing else uses it.
"""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel.estimate.induction_variables.counter_sums import CounterSums, WantedSum, from_other, width
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, Routine, phi_of, renamed, written
from bfsim.kernel.ir.widths import WORD

MARK = ".stepped"


def with_stepped_values(routine: Routine) -> Routine:
    """Return `routine` with a variable in place of each sum that GCC makes a variable of."""
    for header in [loop.header for loop in ControlFlow(routine).loops]:
        for phi in [
            each for each in ControlFlow(routine).blocks[header].instructions if each.opcode == "phi"
        ]:
            routine = _SteppedValues(ControlFlow(routine), header, phi).rewritten()
    return routine


class _SteppedValues:
    """Variables in place of sums of one counter of one loop."""

    def __init__(self, flow: ControlFlow, header: str, phi: Instruction) -> None:
        self.flow, self.sums = flow, CounterSums(flow, header, phi)
        self.loop = self.sums.loop
        self.rows: dict[str, list[Instruction]] = {}
        """What is added at the end of each block."""
        self.phis: list[Instruction] = []
        self.first: list[Instruction] = []
        """What each iteration starts by computing."""
        self.renamed: dict[str, str] = {}
        self.computed: dict[str, Instruction] = {}
        """The values cut from a sum, by name."""

    def rewritten(self) -> Routine:
        """The routine with separate variables for the sums that are cheaper that way."""
        if not self.sums.is_counter():
            return self.flow.routine
        stepped: list[tuple[WantedSum, str]] = []
        for wanted in self.sums.wanted():
            if self.sums.is_cheaper_otherwise(wanted):
                continue
            near = [text for other, name in stepped for text in from_other(wanted, other, name)]
            if near:
                self._compute(wanted, *near[0])
            else:
                stepped.append((wanted, self._step(wanted)))
        return self._with_them() if stepped else self.flow.routine

    def _step(self, wanted: WantedSum) -> str:
        """Make a variable of a sum, and return its name."""
        name, at = f"{wanted.names[0]}{MARK}", self.flow.defined[wanted.names[0]][1]
        before, latch = self.flow.entering(self.loop), self.loop.latch
        start = self._start(wanted, name, at)
        step = str(wanted.times * self.sums.step)
        following = f"{name}.next"
        self.rows.setdefault(latch, []).append(
            written(following, f"add i32 {name}, {step}", (name, step), at)
        )
        self.phis.append(phi_of(name, "i32", ((start, before), (following, latch)), at))
        self._take(wanted, name)
        return name

    def _take(self, wanted: WantedSum, name: str) -> None:
        """Let all users of a sum take the value `name`, narrowed if the sum is narrow."""
        for each in wanted.names:
            made = self.flow.defined[each][1]
            if width(made) == WORD:
                self.renamed[each] = name
            else:
                self.computed[each] = written(each, f"trunc i{WORD} {name} to i{width(made)}", (name,), made)

    def _compute(self, wanted: WantedSum, operation: str, other: str, number: int) -> None:
        """Compute a sum from another one at the start of each iteration."""
        name, at, operands = (
            f"{wanted.names[0]}{MARK}",
            self.flow.defined[wanted.names[0]][1],
            (other, str(number)),
        )
        self.first.append(written(name, f"{operation} i{WORD} {', '.join(operands)}", operands, at))
        self._take(wanted, name)

    def _start(self, wanted: WantedSum, name: str, at: Instruction) -> str:
        """The value of a sum in the first iteration; the instructions that compute it go before the loop."""
        first = self.sums.arms[self.flow.entering(self.loop)]
        sum_ = wanted.rest.plus(self.sums.evolution.affine(first), wanted.times)
        rows = self.rows.setdefault(self.flow.entering(self.loop), [])

        def add(text: str, *operands: str) -> str:
            rows.append(written(f"{name}.first.{len(rows)}", f"{text} {', '.join(operands)}", operands, at))
            return rows[-1].result or ""

        def before(value: str) -> str:
            made = self.flow.instruction(value)
            if made is None or self.flow.is_invariant(value, self.loop):
                return value
            names = {each: before(each) for each in made.operands}
            rows.append(replace(renamed(made, names), result=f"{name}.first.{len(rows)}"))
            return rows[-1].result or ""

        total = ""
        for value, times in sorted(sum_.terms, key=lambda term: -term[1]):
            part = before(value)
            part = part if abs(times) == 1 else add("mul i32", part, str(abs(times)))
            if total or times < 0:
                part = add("add i32" if times > 0 else "sub i32", total or "0", part)
            total = part
        if not total or not sum_.constant:
            return total or str(sum_.constant)
        return add("add i32", total, str(sum_.constant))

    def _with_them(self) -> Routine:
        blocks = []
        for block in self.flow.routine.blocks:
            instructions = [self._renamed(each) for each in block.instructions]
            if block.label == self.loop.header:
                phis = [each for each in instructions if each.opcode == "phi"]
                instructions = [*self.phis, *phis, *self.first, *instructions[len(phis) :]]
            instructions[-1:-1] = self.rows.get(block.label, [])
            blocks.append(replace(block, instructions=tuple(instructions)))
        return replace(self.flow.routine, blocks=tuple(blocks))

    def _renamed(self, each: Instruction) -> Instruction:
        """An instruction that takes the variable in place of the sum, or cuts it."""
        each = self.computed.get(each.result or "", each)
        return renamed(each, self.renamed) if self.sums.takes(each) else each
