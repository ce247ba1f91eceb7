"""Ranges of the words of a routine, from the instructions that compute them and the tests before [gimple-range.cc of GCC 12].

They begin empty and grow until no instruction adds to them; one that grows round a loop is widened. A test on the path
to a use of a value counts for what is computed from it there, and not for the value: when GCC makes instructions, it
knows one range of a value, for all its uses.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from bfsim.kernel.estimate.arithmetic.remainders import quotient_of_rest
from bfsim.kernel.estimate.ranges.range_arithmetic import (
    ANY,
    WORDS,
    Range,
    both,
    computed,
    rest,
    rest_of_signed,
    widened,
    within,
)
from bfsim.kernel.estimate.ranges.said import Said, said_before, said_between
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, arms_of, is_number

MOST_ROUNDS = 12
"""[ours] How often a range may grow before it is widened."""
Facts = Mapping[str, Sequence[tuple[str, str]]]
"""What tests say of values, by their names: relations, and the other value of each."""


class UnsignedRanges:
    """The least and the largest number of each value that a routine computes: in `found`, by name."""

    def __init__(self, flow: ControlFlow) -> None:
        self.flow = flow
        self.found: dict[str, Range] = {}
        self.said = {label: _facts([*said_before(flow, label)]) for label in flow.order}
        rounds = 0
        while self._grow(rounds >= MOST_ROUNDS):
            rounds += 1

    def _grow(self, widens: bool) -> bool:
        """Go through the routine once more, and return whether any range grew."""
        old = dict(self.found)
        for label in self.flow.order:
            for each in self.flow.blocks[label].instructions:
                new = self._of(each, label) if each.result else None
                if new is not None and each.result:
                    joined = both(new, self.found.get(each.result, new))
                    has_grown = joined != self.found.get(each.result, joined)
                    is_widened = widens and has_grown and each.opcode == "phi"
                    self.found[each.result] = widened(joined) if is_widened else joined
        return old != self.found

    def _of(self, each: Instruction, label: str) -> Range | None:
        """Return the range of an instruction's result; None if no value is known to reach it yet."""
        if each.opcode == "phi":
            arms = [self._on_way(value, way, label) for way, value in arms_of(each).items()]
            come = [arm for arm in arms if arm is not None]
            return (min(low for low, _ in come), max(high for _, high in come)) if come else None
        operands = each.operands[1:] if each.opcode == "select" else each.operands
        ranges = [one for one in (self._at(value, label) for value in operands) if one is not None]
        if len(ranges) < len(operands):
            return None
        if (division := quotient_of_rest(self.flow, each)) is not None:
            divisor = self._at(division.operands[1], label) or ANY
            return (rest if division.opcode == "udiv" else rest_of_signed)(ranges[0], divisor)
        return computed(each, ranges)

    def _at(self, value: str, label: str) -> Range | None:
        """Return the range of a value in a block; None if no value is known to reach it."""
        return self._within_said(value, self.said.get(label, {}))

    def _on_way(self, value: str, label: str, behind: str) -> Range | None:
        """Return the range of a value on the edge from a block to the one `behind`."""
        said = self.said.get(label, {})
        for name, relation, other in said_between(self.flow, label, behind):
            said = {**said, name: [*said.get(name, ()), (relation, other)]}
        return self._within_said(value, said)

    def _within_said(self, value: str, said: Facts) -> Range | None:
        if is_number(value):
            return int(value) % WORDS, int(value) % WORDS
        each = self.flow.instruction(value)
        if each is not None and value not in self.found:
            return None
        found: Range | None = self.found.get(value, ANY)
        names = (value, each.operands[0]) if each is not None and each.opcode == "sext" else (value,)
        facts = [fact for name in names for fact in said.get(name, ())]
        for relation, other in sorted(
            facts, key=lambda fact: "l" in fact[0]
        ):  # first those that say it is positive
            beside = (int(other) % WORDS,) * 2 if is_number(other) else self.found.get(other, ANY)
            found = within(found, relation, beside) if found is not None else None
        return found


def _facts(said: Sequence[Said]) -> Facts:
    """Return what tests say, by value, in the order of the tests on the path."""
    found: dict[str, list[tuple[str, str]]] = {}
    for value, relation, other in reversed(said):
        found.setdefault(value, []).append((relation, other))
    return found
