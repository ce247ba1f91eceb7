"""Values that a loop steps along: of `a[i] = 100 - 3 * i` each iteration takes 3 from the last one [tree-ssa-loop-ivopts.cc of GCC 12].

So the counter is not needed where nothing else wants it. To step a value costs five, an operation on another one four
[determine_iv_cost, get_computation_cost]: what one operation makes of a value that is there is made of that. What a pointer to bytes
stands for is not stepped, either (`pointer_differences`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from bfsim.kernel.estimate.induction_variables.pointer_differences import sum_of
from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.estimate.loops.same_values import is_same
from bfsim.kernel.estimate.loops.scalar_evolution import Affine, ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import (
    Instruction,
    Routine,
    arms_of,
    phi_of,
    renamed,
    written,
)
from bfsim.kernel.ir.widths import WORD

MARK = ".stepped"
LINEAR = ("add", "sub", "mul", "shl", "or", "xor", "trunc")
STEP_COST, OPERATION_COST = 5, 4
SHARE = 2
"""Iterations for each that runs a block which not all of them run, as is guessed here."""


@dataclass(frozen=True)
class _Wanted:
    """Values of a loop that are the same sum: `times` its counter, and `rest`."""

    times: int
    rest: Affine
    names: tuple[str, ...]
    is_steady: bool
    """Whether every iteration wants one."""


def with_stepped_values(routine: Routine) -> Routine:
    """Return `routine` with a variable in place of each sum that GCC makes one of."""
    for header in [loop.header for loop in ControlFlow(routine).loops]:
        for phi in [
            each for each in ControlFlow(routine).blocks[header].instructions if each.opcode == "phi"
        ]:
            routine = _SteppedValues(ControlFlow(routine), header, phi).rewritten()
    return routine


class _SteppedValues:
    """What one loop wants of one of its counters."""

    def __init__(self, flow: ControlFlow, header: str, phi: Instruction) -> None:
        self.flow, self.phi = flow, phi
        self.loop = next(each for each in flow.loops if each.header == header)
        self.counter = phi.result or ""
        self.evolution = ScalarEvolution(flow, InvariantCodeMotion(flow))
        self.arms = arms_of(phi)
        self.itself = Affine(((self.counter, 1),))
        self.rows: dict[str, list[Instruction]] = {}
        """What is added, by block: at its end."""
        self.phis: list[Instruction] = []
        self.first: list[Instruction] = []
        """What each iteration computes first."""
        self.renamed: dict[str, str] = {}
        self.computed: dict[str, Instruction] = {}
        """What is cut from a sum, by name."""

    def rewritten(self) -> Routine:
        """The routine with variables of their own for the sums that are cheaper so."""
        if not self._is_counter():
            return self.flow.routine
        stepped: list[tuple[_Wanted, str]] = []
        for wanted in self._wanted():
            if self._is_cheaper_otherwise(wanted):
                continue
            near = [text for other, name in stepped for text in _from_other(wanted, other, name)]
            if near:
                self._compute(wanted, *near[0])
            else:
                stepped.append((wanted, self._step(wanted)))
        return self._with_them() if stepped else self.flow.routine

    def _is_counter(self) -> bool:
        """Whether it is stepped by a number in each iteration, and a register or a pointer counts these."""
        increment = self.evolution.increment(self.counter, self.loop)
        return (
            self.phi.text.startswith("phi i32 ")
            and increment is not None
            and increment.moves
            and not increment.symbolic
            and set(self.arms) == {self.flow.entering(self.loop), self.loop.latch}
            and (self.evolution.is_counted(self.loop) or bool(self.pointer_steps))
        )

    @property
    def pointer_steps(self) -> set[int]:
        """By how much the addresses of the loop advance, in bytes."""
        found = set()
        for label in self.flow.inside(self.loop):
            for each in self.flow.blocks[label].instructions:
                if each.opcode in ("load", "store"):
                    increment = self.evolution.increment(each.operands[-1], self.loop)
                    if increment is not None and not increment.symbolic:
                        found.add(abs(increment.constant))
        return found - {0}

    def _wanted(self) -> list[_Wanted]:
        """The sums that something wants which is neither one itself nor an address nor the end of the loop."""
        found: dict[Affine, dict[str, bool]] = {}
        for label in self.flow.inside(self.loop):
            for each in self.flow.blocks[label].instructions:
                if self._is_sum(each) and self._home(each, label) is self.loop:
                    homes = [home for user, home in self._users(each.result or "") if self._takes(user)]
                    if homes and each.result != self.arms[self.loop.latch]:
                        steady = any(self.flow.every_iteration(home, self.loop) for home in homes)
                        found.setdefault(sum_of(self.evolution, each.result or ""), {})[each.result or ""] = (
                            steady
                        )
        wanted = []
        for affine, names in found.items():
            times = dict(affine.terms)[self.counter]
            if affine == self.itself:
                continue
            rest = affine.plus(Affine(((self.counter, times),)), -1)
            wanted.append(_Wanted(times, rest, tuple(names), any(names.values())))
        return sorted(wanted, key=lambda each: (not each.is_steady, abs(each.times)))

    def _home(self, each: Instruction, label: str) -> Loop | None:
        """The innermost loop in which an instruction of block `label` is computed."""
        return self.flow.innermost(self.evolution.code_motion.of.get(each.result or "", label))

    def _is_sum(self, each: Instruction) -> bool:
        """Whether an instruction computes the counter times a number, and what does not change in the loop."""
        if each.opcode not in LINEAR or _width(each) == 1:
            return False
        terms = dict(sum_of(self.evolution, each.result or "").terms)
        return self.counter in terms and all(self._is_fixed(name) for name in terms if name != self.counter)

    def _is_fixed(self, name: str) -> bool:
        """Whether a value can be computed before the loop."""
        made = self.flow.instruction(name)
        return self.flow.is_invariant(name, self.loop) or (
            made is not None and is_same(self.flow, self.loop, made)
        )

    def _users(self, name: str) -> Iterator[tuple[Instruction, str]]:
        """What uses a value, and in which block."""
        for label, block in self.flow.blocks.items():
            for each in block.instructions:
                if name in each.operands:
                    arms = arms_of(each).items() if each.opcode == "phi" else ()
                    homes = [source for source, value in arms if value == name]
                    moved = self.evolution.code_motion.of.get(each.result or "", label)
                    yield from ((each, home) for home in homes or [moved])

    def _takes(self, user: Instruction) -> bool:
        """Whether an instruction wants the value of a sum itself."""
        result = user.result or ""
        return (
            user.opcode != "getelementptr"
            and result not in (self.evolution.exit_test(self.loop), self.counter)
            and not self._is_sum(user)
        )

    def _wants_counter(self) -> bool:
        """Whether anything wants the counter itself, or its next value."""
        narrow = (
            each.result or ""
            for label in self.flow.inside(self.loop)
            for each in self.flow.blocks[label].instructions
            if each.opcode == "trunc" and sum_of(self.evolution, each.result or "") == self.itself
        )
        names = (self.counter, self.arms[self.loop.latch], *narrow)
        return any(self._takes(user) for name in names for user, _ in self._users(name))

    def _is_cheaper_otherwise(self, wanted: _Wanted) -> bool:
        """Whether a sum costs less if it is made of a pointer, or of the counter that is there anyway."""
        increment = self.evolution.increment(self.counter, self.loop)
        assert increment is not None
        step = abs(wanted.times * increment.constant)
        if step == 1 and 1 in self.pointer_steps:
            return True
        if not wanted.is_steady and any(step % each == 0 for each in self.pointer_steps):
            return True
        if not self._wants_counter():
            return False
        adds = bool(wanted.rest.terms or wanted.rest.constant) and wanted.times != -1
        operations = _operations(wanted.times) + adds
        return operations * OPERATION_COST < STEP_COST * (1 if wanted.is_steady else SHARE)

    def _step(self, wanted: _Wanted) -> str:
        """Make a variable of a sum, and return its name."""
        name, at = f"{wanted.names[0]}{MARK}", self.flow.defined[wanted.names[0]][1]
        increment = self.evolution.increment(self.counter, self.loop)
        assert increment is not None
        before, latch = self.flow.entering(self.loop), self.loop.latch
        start = self._start(wanted, name, at)
        step = str(wanted.times * increment.constant)
        following = f"{name}.next"
        self.rows.setdefault(latch, []).append(
            written(following, f"add i32 {name}, {step}", (name, step), at)
        )
        self.phis.append(phi_of(name, "i32", ((start, before), (following, latch)), at))
        self._take(wanted, name)
        return name

    def _take(self, wanted: _Wanted, name: str) -> None:
        """Have all that wants a sum take the value `name`, cut to what is as narrow as that."""
        for each in wanted.names:
            made = self.flow.defined[each][1]
            if _width(made) == WORD:
                self.renamed[each] = name
            else:
                self.computed[each] = written(each, f"trunc i{WORD} {name} to i{_width(made)}", (name,), made)

    def _compute(self, wanted: _Wanted, operation: str, other: str, number: int) -> None:
        """Compute a sum of another one at the start of each iteration."""
        name, at, operands = (
            f"{wanted.names[0]}{MARK}",
            self.flow.defined[wanted.names[0]][1],
            (other, str(number)),
        )
        self.first.append(written(name, f"{operation} i{WORD} {', '.join(operands)}", operands, at))
        self._take(wanted, name)

    def _start(self, wanted: _Wanted, name: str, at: Instruction) -> str:
        """What a sum is in the first iteration; what computes it is put before the loop."""
        first = self.arms[self.flow.entering(self.loop)]
        sum_ = wanted.rest.plus(self.evolution.affine(first), wanted.times)
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
        return renamed(each, self.renamed) if self._takes(each) else each


def _width(each: Instruction) -> int:
    """Bits of what an instruction gives."""
    return int(each.text.rsplit(" i", 1)[1]) if each.opcode == "trunc" else each.bits


def _operations(times: int) -> int:
    """How many operations make a multiple: a shift, or a sum with one."""
    if times == 1:
        return 0
    return 1 if abs(times).bit_count() == 1 or times in (3, 5) else 2


def _from_other(wanted: _Wanted, other: _Wanted, name: str) -> Iterator[tuple[str, str, int]]:
    """What makes a sum of another one, `name`, in one operation: a shift, or a number that is added."""
    times, rest = divmod(wanted.times, other.times)
    apart = wanted.rest.plus(other.rest, -times)
    if not rest and times > 1 and times.bit_count() == 1 and apart == Affine():
        yield "shl", name, times.bit_length() - 1
    if not rest and times == 1 and not apart.terms:
        yield "add", name, apart.constant
