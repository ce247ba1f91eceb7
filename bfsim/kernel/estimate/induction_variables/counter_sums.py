"""Sums of a counter that a loop uses: which there are, and which are cheaper as separate variables [tree-ssa-loop-ivopts.cc of GCC 12].

Stepping a value costs five, an operation on another one four [determine_iv_cost, get_computation_cost]: a value that
takes one operation on an existing value is computed from that. A value that a pointer to bytes stands for is not
stepped, either (`pointer_differences`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from bfsim.kernel.estimate.induction_variables.counter_wishes import sum_of
from bfsim.kernel.estimate.loops.invariant_code_motion import InvariantCodeMotion
from bfsim.kernel.estimate.loops.same_values import is_same
from bfsim.kernel.estimate.loops.scalar_evolution import Affine, ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction, arms_of

LINEAR = ("add", "sub", "mul", "shl", "or", "xor", "trunc")
STEP_COST, OPERATION_COST = 5, 4
SHARE = 2
"""Iterations for each that runs a conditional block, as guessed here."""


@dataclass(frozen=True)
class WantedSum:
    """Values of a loop that are the same sum: `times` its counter, plus `rest`."""

    times: int
    rest: Affine
    names: tuple[str, ...]
    is_steady: bool
    """Whether every iteration uses one."""


class CounterSums:
    """The sums of the counter `phi` that one loop uses."""

    def __init__(self, flow: ControlFlow, header: str, phi: Instruction) -> None:
        self.flow, self.phi = flow, phi
        self.loop = next(each for each in flow.loops if each.header == header)
        self.counter = phi.result or ""
        self.evolution = ScalarEvolution(flow, InvariantCodeMotion(flow))
        self.arms = arms_of(phi)
        self.itself = Affine(((self.counter, 1),))

    def is_counter(self) -> bool:
        """Whether it is stepped by a number in each iteration, and a register or a pointer counts these."""
        increment = self.evolution.increment(self.counter, self.loop)
        return (
            self.phi.text.startswith("phi i32 ")
            and increment is not None
            and increment.moves
            and not increment.symbolic
            and set(self.arms) == {self.flow.entering(self.loop), self.loop.latch}
            and (self.evolution.is_counted(self.loop) or bool(self._pointer_steps))
        )

    @property
    def _pointer_steps(self) -> set[int]:
        """By how much the addresses of the loop advance, in bytes."""
        found = set()
        for label in self.flow.inside(self.loop):
            for each in self.flow.blocks[label].instructions:
                if each.opcode in ("load", "store"):
                    increment = self.evolution.increment(each.operands[-1], self.loop)
                    if increment is not None and not increment.symbolic:
                        found.add(abs(increment.constant))
        return found - {0}

    def wanted(self) -> list[WantedSum]:
        """The sums with a use that is neither such a sum, nor an address, nor the end of the loop."""
        found: dict[Affine, dict[str, bool]] = {}
        for label in self.flow.inside(self.loop):
            for each in self.flow.blocks[label].instructions:
                if self._is_sum(each) and self._home(each, label) is self.loop:
                    homes = [home for user, home in self._users(each.result or "") if self.takes(user)]
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
            wanted.append(WantedSum(times, rest, tuple(names), any(names.values())))
        return sorted(wanted, key=lambda each: (not each.is_steady, abs(each.times)))

    def _home(self, each: Instruction, label: str) -> Loop | None:
        """The innermost loop in which an instruction of block `label` is computed."""
        return self.flow.innermost(self.evolution.code_motion.of.get(each.result or "", label))

    def _is_sum(self, each: Instruction) -> bool:
        """Whether an instruction computes the counter times a number, plus what does not change in the loop."""
        if each.opcode not in LINEAR or width(each) == 1:
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
        """The users of a value, and their blocks."""
        for label, block in self.flow.blocks.items():
            for each in block.instructions:
                if name in each.operands:
                    arms = arms_of(each).items() if each.opcode == "phi" else ()
                    homes = [source for source, value in arms if value == name]
                    moved = self.evolution.code_motion.of.get(each.result or "", label)
                    yield from ((each, home) for home in homes or [moved])

    def takes(self, user: Instruction) -> bool:
        """Whether an instruction uses the value of a sum itself."""
        result = user.result or ""
        return (
            user.opcode != "getelementptr"
            and result not in (self.evolution.exit_test(self.loop), self.counter)
            and not self._is_sum(user)
        )

    def _wants_counter(self) -> bool:
        """Whether anything uses the counter itself, or its next value."""
        narrow = (
            each.result or ""
            for label in self.flow.inside(self.loop)
            for each in self.flow.blocks[label].instructions
            if each.opcode == "trunc" and sum_of(self.evolution, each.result or "") == self.itself
        )
        names = (self.counter, self.arms[self.loop.latch], *narrow)
        return any(self.takes(user) for name in names for user, _ in self._users(name))

    def is_cheaper_otherwise(self, wanted: WantedSum) -> bool:
        """Whether a sum costs less if it is computed from a pointer, or from the counter that exists anyway."""
        step = abs(wanted.times * self.step)
        if step == 1 and 1 in self._pointer_steps:
            return True
        if not wanted.is_steady and any(step % each == 0 for each in self._pointer_steps):
            return True
        if not self._wants_counter():
            return False
        adds = bool(wanted.rest.terms or wanted.rest.constant) and wanted.times != -1
        operations = _operations(wanted.times) + adds
        return operations * OPERATION_COST < STEP_COST * (1 if wanted.is_steady else SHARE)

    @property
    def step(self) -> int:
        """By how much the counter advances."""
        increment = self.evolution.increment(self.counter, self.loop)
        assert increment is not None
        return increment.constant


def width(each: Instruction) -> int:
    """Bits of an instruction's result."""
    return int(each.text.rsplit(" i", 1)[1]) if each.opcode == "trunc" else each.bits


def _operations(times: int) -> int:
    """How many operations a multiple takes: a shift, or a sum with one."""
    if times == 1:
        return 0
    return 1 if abs(times).bit_count() == 1 or times in (3, 5) else 2


def from_other(wanted: WantedSum, other: WantedSum, name: str) -> Iterator[tuple[str, str, int]]:
    """The one operation that makes a sum from another one, `name`: a shift, or a number that is added."""
    times, rest = divmod(wanted.times, other.times)
    apart = wanted.rest.plus(other.rest, -times)
    if not rest and times > 1 and times.bit_count() == 1 and apart == Affine():
        yield "shl", name, times.bit_length() - 1
    if not rest and times == 1 and not apart.terms:
        yield "add", name, apart.constant
