"""Pointers that do without a step, a stride or a register of their own [tree-ssa-loop-ivopts.cc of GCC 12].

A pointer with a step that no access makes costs an addition in each iteration. To compute an address from another pointer costs one, too, and no
register; where that is where the other one is next, as `a[p + w]` beside `a[p]` for `p = y * w + x`, its step computes both.
"""

from __future__ import annotations

from collections.abc import Sequence

from bfsim.kernel.estimate.induction_variables.induction_variable import InductionVariable
from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow

MANY = 3
"""[ours] So many pointers along one array by one loop are worth fewer."""


def share_pointers(
    variables: Sequence[InductionVariable], flow: ControlFlow, evolution: ScalarEvolution
) -> None:
    """Find which of a routine's variables another one's pointer serves, and which have its stride."""
    shared = _SharedPointers(variables, flow, evolution)
    shared.share_strides()
    for variable in variables:
        variable.neighbour = next((each for each in variables if shared.serves(each, variable)), None)
        if variable.neighbour is not None:
            variable.distance = shared.distance(variable.neighbour, variable)
            variable.follows = shared.follows(variable)


def is_steady(flow: ControlFlow, variable: InductionVariable) -> bool:
    """Whether every iteration makes one of the accesses."""
    return any(flow.every_iteration(label, variable.loop) for label, _, _ in variable.accesses)


class _SharedPointers:
    def __init__(
        self, variables: Sequence[InductionVariable], flow: ControlFlow, evolution: ScalarEvolution
    ) -> None:
        self.variables, self.flow, self.evolution = variables, flow, evolution

    def _terms(self, variable: InductionVariable) -> tuple[tuple[str, int], ...]:
        return self.evolution.affine(variable.accesses[0].instruction.operands[-1]).terms

    def _moving(self, variable: InductionVariable) -> tuple[tuple[str, int], ...]:
        """What of an address changes in the loop, with factors."""
        is_fixed = self.evolution.code_motion.is_invariant
        return tuple(each for each in self._terms(variable) if not is_fixed(each[0], variable.loop))

    def share_strides(self) -> None:
        """Find the variables that step as far as another one before them."""
        first: dict[tuple[str, frozenset[tuple[str, int]]], str] = {}
        for variable in self.variables:
            key = variable.loop.header, frozenset(self._moving(variable))
            variable.like = first.setdefault(key, variable.name)

    def distance(self, one: InductionVariable, other: InductionVariable) -> tuple[tuple[str, int], ...]:
        """Return the terms by which the second variable's pointer is apart from the first one's."""
        here, there = (
            self.evolution.affine(each.accesses[0].instruction.operands[-1]) for each in (one, other)
        )
        return there.plus(here, -1).terms

    def serves(self, one: InductionVariable, other: InductionVariable) -> bool:
        """Whether the pointer of one variable takes the place of another's [cost of an iv use there].

        An access that not every iteration makes costs less where it is computed from a pointer that is there than with a pointer of its own,
        which every iteration would have to step. Of several each is computed, whatever the guess of how often its block runs: a block counts
        once at least [determine_group_iv_cost_address; determine_scaling_factor].
        """
        alike = (one.loop, one.root, one.increment) == (other.loop, other.root, other.increment)
        if one is other or not alike or not is_steady(self.flow, one):
            return False
        is_fixed = self.evolution.code_motion.is_invariant
        if (
            not all(is_fixed(name, one.loop) for name, _ in self.distance(one, other))
            or len(other.accesses) > 1
        ):
            return False
        return self._crowd(one, other) if is_steady(self.flow, other) else not one.increment.symbolic

    def _crowd(self, one: InductionVariable, other: InductionVariable) -> bool:
        """Whether many pointers would have to be stepped, of which `one` is the first."""
        stepped = [
            each
            for each in self.variables
            if each.loop is one.loop and each.root == one.root and not each.steps_free
        ]
        return len(stepped) >= MANY and one is stepped[0] and other in stepped

    def follows(self, variable: InductionVariable) -> bool:
        """Whether a pointer is one step of its neighbour's from that: the product of its index grows by what they are apart."""
        loop, moving = variable.loop, self._moving(variable)
        if len(moving) != 1 or len(variable.distance) != 1:
            return False
        ((name, times),), ((width, apart),) = moving, variable.distance
        product = self.flow.instruction(name)
        if product is None or (product.opcode, times) != ("mul", apart) or width not in product.operands:
            return False
        gains = [self.evolution.increment(each, loop) for each in product.operands if each != width]
        return [each and (each.constant, each.symbolic) for each in gains] == [(1, False)]
