"""Counters that a loop compares besides its end: how likely each such test is to hold [predict_iv_comparison in predict.cc of GCC 12]."""

from __future__ import annotations

from typing import NamedTuple

from bfsim.kernel.estimate.loops.scalar_evolution import ScalarEvolution
from bfsim.kernel.ir.control_flow import ControlFlow, Loop
from bfsim.kernel.ir.text import Instruction, is_number, predicate

IV_COMPARE = 0.64  # hit rate [predict.def]
OPPOSITE = {"lt": "gt", "le": "ge", "gt": "lt", "ge": "le", "eq": "eq", "ne": "ne"}


class Comparison(NamedTuple):
    """A comparison of a counter: the relation, the other value, the counter's start and its step."""

    relation: str
    other: str
    start: str
    step: int


class CounterComparisons:
    """How likely each test of a counter is to hold, by the label of its block."""

    def __init__(self, flow: ControlFlow, evolution: ScalarEvolution) -> None:
        self.flow, self.evolution = flow, evolution
        self.votes: dict[str, list[float]] = {}
        for loop in flow.loops:
            if not flow.is_split(loop):
                self._counters(loop)

    def _counters(self, loop: Loop) -> None:
        """A test of the loop's counter: equality is unlikely, and what holds in the loop is likely [predict_iv_comparison]."""
        bound = self._comparison(self.flow.instruction(self.evolution.exit_test(loop) or ""), loop)
        if bound is None:
            return
        exits = set(self.flow.exits(loop))
        for label in self.flow.inside(loop):
            block = self.flow.blocks[label]
            if label in exits or len(set(block.successors)) != 2 or block.terminator.opcode != "br":
                continue
            test = self._comparison(self.flow.instruction(block.terminator.operands[0]), loop)
            if test is not None and (vote := self._by_counter(test, bound)) is not None:
                self.votes.setdefault(label, []).append(vote)

    def _comparison(self, test: Instruction | None, loop: Loop) -> Comparison | None:
        """A test that compares a counter of `loop` with what does not change in it."""
        if test is None or test.opcode != "icmp":
            return None
        gains = [self.evolution.increment(each, loop) for each in test.operands[:2]]
        moving = [number for number, gain in enumerate(gains) if gain is not None and gain.moves]
        if None in gains or len(moving) != 1:
            return None
        counter, other = test.operands[moving[0]], test.operands[1 - moving[0]]
        if not self.flow.is_invariant(other, loop):
            return None  # a sum that is written in the loop: with types of stdint.h, it is no sum of a name [get_base_value]
        gain = gains[moving[0]]
        assert gain is not None
        relation = predicate(test)[-2:]
        start = self.evolution.first(counter, loop)
        if gain.symbolic or start is None:
            return None
        return Comparison(OPPOSITE[relation] if moving[0] else relation, other, start, gain.constant)

    def _by_counter(self, test: Comparison, bound: Comparison) -> float | None:
        """How likely a comparison is to hold, besides the one that bounds the loop."""
        if test.relation in ("eq", "ne"):
            return IV_COMPARE if test.relation == "ne" else 1 - IV_COMPARE
        if not self._coherent(bound.start, test.start):
            return None
        if all(is_number(each) for each in (bound.other, test.other, test.start)):
            return None
        below = test.relation in ("lt", "le")
        if self._coherent(bound.other, test.other):
            goes_up = bound.relation in ("lt", "le") or (bound.relation == "ne" and bound.step > 0)
            return IV_COMPARE if below == goes_up else 1 - IV_COMPARE
        if self._coherent(bound.start, test.other):
            return IV_COMPARE if below == (bound.step < 0) else 1 - IV_COMPARE
        return None

    def _coherent(self, one: str, other: str) -> bool:
        """Whether two values are equal, or both constants, or one is the other plus a constant [expr_coherent_p]."""
        if one == other or (is_number(one) and is_number(other)):
            return True
        return any(
            (each := self.flow.instruction(here)) is not None
            and [name for name in each.operands if not is_number(name)] == [there]
            for here, there in ((one, other), (other, one))
        )
