"""Known numbers, taken from the variable that has them where paths join, so that nothing is loaded [tree-ssa-uncprop.cc of GCC 12].

After `if state == 3`, passes put 3 in place of `state`, which helps them. If `state` is then chosen among others, 3
would have to be loaded into its register, where it already is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from bfsim.kernel.estimate.choices.narrow_choices import CHOSEN
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import (
    Instruction,
    Routine,
    arms_of,
    each_arm,
    is_constant,
    is_number,
    predicate,
    with_each_arm,
)

FLAG = {"0": "1", "1": "0"}
"""The other value of a flag."""


def with_known_values(routine: Routine) -> Routine:
    """Return `routine` with variables in place of known numbers in its choices."""
    known = KnownValues(ControlFlow(routine))
    blocks = (
        replace(block, instructions=tuple(known.chosen(block.label, each) for each in block.instructions))
        for block in routine.blocks
    )
    return replace(routine, blocks=tuple(blocks))


@dataclass(frozen=True)
class KnownValues:
    """What the tests of a routine have found out about its variables."""

    flow: ControlFlow

    def chosen(self, home: str, each: Instruction) -> Instruction:
        """Return an instruction of block `home`, with variables in place of known numbers if it is a choice of words or truths."""
        if not each.text.startswith(("phi i32 ", "phi i1 ")):
            return each
        arms = [
            (value if self._is_computed(each, label, home) else self._variable(value, label, home), label)
            for value, label in each_arm(each)
        ]
        return each if arms == each_arm(each) else with_each_arm(each, arms)

    def number(self, name: str, label: str, home: str) -> str | None:
        """Return the number that a variable is known to be on the edge from block `label` to block `home`."""
        return next((number for each, number in self._found_out(label, home) if each == name), None)

    def _is_computed(self, choice: Instruction, label: str, home: str) -> bool:
        """Whether a choice between numbers was computed before [tree-ssa-phiopt.cc]: `1 if test else 0`, or by a test that chooses nothing else."""
        is_expression = (choice.result or "").startswith(f"%{CHOSEN}")
        if is_expression and all(is_constant(value) for value, _ in each_arm(choice)):
            return True
        phis = [each for each in self.flow.blocks[home].instructions if each.opcode == "phi"]
        return any(
            label != other
            and self.flow.tested(label) == self.flow.tested(other)
            and all(arms_of(phi)[label] == arms_of(phi)[other] for phi in phis if phi is not choice)
            for value, other in each_arm(choice)
            if is_constant(value)
        )

    def _variable(self, value: str, label: str, home: str) -> str:
        if not is_constant(value):
            return value
        equal = (name for name, number in self._found_out(label, home) if number == value)
        return next(equal, value)

    def _found_out(self, label: str, home: str) -> Iterator[tuple[str, str]]:
        """Yield the variables that are numbers on the edge from block `label` to block `home`, the latest finding first."""
        ways = self.flow.blocks[label].successors
        if ways.count(home) == 1:
            yield from self._by_test(label, home)
        while len(before := self.flow.predecessors[label]) == 1:
            yield from self._by_test(before[0], label)
            (label,) = before

    def _by_test(self, label: str, way: str) -> Iterator[tuple[str, str]]:
        """Yield what the test at the end of block `label` finds out if it goes to block `way`."""
        ending = self.flow.blocks[label].terminator
        test = self.flow.instruction(ending.operands[0]) if ending.operands else None
        ways = self.flow.blocks[label].successors
        if ending.opcode != "br" or test is None or len(set(ways)) != 2:
            return
        if test.opcode == "phi":
            yield ending.operands[0], ("true", "false")[ways.index(way)]
        if test.opcode != "icmp":
            return
        name, number = test.operands
        if predicate(test) not in ("eq", "ne") or not self._is_word(name, test) or not is_number(number):
            return
        if (ways[0] == way) is (predicate(test) == "eq"):
            yield name, number
        elif number in FLAG and self._is_flag(name, set()):
            yield name, FLAG[number]

    def _is_word(self, name: str, test: Instruction) -> bool:
        """Whether a test is of a word: GCC tests a byte or a half-word as it is [match.pd]."""
        made = self.flow.instruction(name)
        return " i32 " in test.text and not (made is not None and made.opcode in ("zext", "sext"))

    def _is_flag(self, name: str, seen: set[str]) -> bool:
        """Whether a value is 0 or 1 on all paths [ssa_name_has_boolean_range]."""
        made = self.flow.instruction(name)
        if name in FLAG or name in seen:
            return True
        if made is None or made.opcode != "phi":
            return made is not None and made.opcode == "zext" and " i1 " in made.text
        return all(self._is_flag(value, seen | {name}) for value, _ in each_arm(made))
