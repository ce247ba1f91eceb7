"""Webs: values that share one register, and the bank of registers in which each of them lives."""

from __future__ import annotations

from collections import Counter as Tally
from collections import defaultdict

from bfsim.kernel.lowering.context import Context
from bfsim.kernel.lowering.groups import is_merged_pointer
from bfsim.kernel.lowering.liveness import Liveness, liveness
from bfsim.kernel.lowering.steps import Bank, Steps

ROUNDS = 3  # in which values settle in the bank of those they are computed with


class Webs:
    """The webs of one routine. A phi and its arms are one web, unless some of its values are alive together."""

    def __init__(self, context: Context, steps: Steps) -> None:
        self.context, self.flow, self.steps = context, context.flow, steps
        self.frequency = context.likelihood.frequency
        self.phis = self._phis()
        self.web: dict[str, str] = {}
        self.bank: dict[str, Bank] = {}
        self.live = Liveness()
        self.analyse()
        self._coalesce()
        self._choose_banks()

    def _phis(self) -> dict[str, list[tuple[str, str]]]:
        found: dict[str, list[tuple[str, str]]] = {}
        for block in self.flow.routine.blocks:
            if block.label in self.context.replaced:
                continue
            for each in block.instructions:
                shape = self.context.shape_of(each)
                if (
                    each.opcode == "phi"
                    and not is_merged_pointer(each)
                    and self.context.needs.emits(each)
                    and (shape is None or self.context.others(each))
                ):
                    arms = self.context.others(each)
                    found[each.result or ""] = [
                        (self.context.name(value), label) for value, label in arms if value != "poison"
                    ]
                    if shape is not None:
                        found[each.result or ""].append((self.context.shaped(each), shape.label))
        return found

    def analyse(self) -> None:
        """Find what is alive where; again whenever steps were inserted."""
        merged = {
            phi: [(value, label) for value, label in arms if not value.startswith("#")]
            for phi, arms in self.phis.items()
        }
        self.live = liveness(self.flow, self.steps, merged)

    def find(self, name: str) -> str:
        """The web that a value belongs to: values that share a register."""
        while self.web.get(name, name) != name:
            name = self.web[name]
        return name

    def _coalesce(self) -> None:
        """Give a phi and its arms one register, the most frequent copies first, unless both are wanted at once."""
        apart = self._interference()
        for phi, value in self._stepped():
            apart[phi].discard(value)
            apart[value].discard(phi)
        members = {name: {name} for name in apart}
        copies = [
            (self.frequency[label], phi, value)
            for phi, arms in self.phis.items()
            for value, label in arms
            if not value.startswith("#")
        ]
        for _, phi, value in sorted(copies, key=lambda copy: -copy[0]):
            one, other = self.find(phi), self.find(value)
            mine, theirs = members.setdefault(one, {one}), members.setdefault(other, {other})
            if one == other or any(not apart[name].isdisjoint(theirs) for name in mine):
                continue
            self.web[other] = one
            mine |= theirs

    def _stepped(self) -> list[tuple[str, str]]:
        """Counters of loops and their next values, which only the next turn wants: they are stepped last, in place."""
        found = []
        for phi, arms in self.phis.items():
            label, each = self.flow.defined[phi]
            latches = [loop.latch for loop in self.flow.loops if loop.header == label]
            for value, source in arms:
                step = self.flow.instruction(value)
                steps = step is not None and step.opcode == "add" and step.operands[0] == phi
                if steps and source in latches and self.flow.users[value] == [each]:
                    found.append((phi, value))
        return found

    def _interference(self) -> defaultdict[str, set[str]]:
        """Of each value: those that are alive where it is computed, or that are computed while it is alive."""
        apart: defaultdict[str, set[str]] = defaultdict(set)

        def keep_apart(name: str, alive: set[str]) -> None:
            apart[name] |= alive - {name}
            for other in alive - {name}:
                apart[other].add(name)

        entry = self.flow.routine.blocks[0].label
        for label in self.flow.order:
            alive = set(self.live.out[label])
            for step in reversed(self.steps.of[label]):
                if step.result:
                    keep_apart(step.result, alive)
                    alive.discard(step.result)
                alive.update(name for name, _ in step.uses if not name.startswith("#"))
            here = {phi for phi in self.phis if self.flow.defined[phi][0] == label}
            for name in alive if label == entry else here:
                keep_apart(name, alive | here)
        return apart

    def _choose_banks(self) -> None:
        """Where a value's definition leaves the choice, the bank that needs fewer moves."""
        fixed, wants, friends = self._wishes()
        names = {self.find(each) for each in self._names()}
        self.bank = {name: _majority(fixed.get(name)) or Bank.DATA for name in names}
        for _ in range(ROUNDS):
            for name in sorted(names - fixed.keys()):
                votes = Tally(wants.get(name, Tally()))
                for friend, weight in friends.get(name, Tally()).items():
                    if friend != name and (friend in fixed or friend in wants):
                        votes[self.bank[friend]] += weight // 2
                self.bank[name] = _majority(votes) or Bank.DATA

    def _names(self) -> set[str]:
        steps = [step for block in self.steps.of.values() for step in block]
        return (
            {name for step in steps for name, _ in step.uses}
            | {step.result for step in steps if step.result}
            | {*self.phis}
        )

    def _wishes(self) -> tuple[dict[str, Tally[Bank]], dict[str, Tally[Bank]], dict[str, Tally[str]]]:
        """Of each web: banks that its definitions fix, banks that its uses want, and webs it is computed with."""
        fixed: defaultdict[str, Tally[Bank]] = defaultdict(Tally)
        wants: defaultdict[str, Tally[Bank]] = defaultdict(Tally)
        friends: defaultdict[str, Tally[str]] = defaultdict(Tally)
        for label, block in self.steps.of.items():
            weight = int(self.frequency[label] * 1000) + 1
            for step in block:
                own = self.find(step.result) if step.result else None
                if own and step.bank is not Bank.ANY:
                    fixed[own][step.bank] += weight
                for name, bank in step.uses:
                    other = self.find(name)
                    if bank is not Bank.ANY and not name.startswith("#"):
                        wants[other][bank] += weight
                    elif own and not name.startswith("#"):
                        friends[other][own] += weight
                        friends[own][other] += weight
        return fixed, wants, friends


def _majority(votes: Tally[Bank] | None) -> Bank | None:
    if not votes:
        return None
    return max((Bank.DATA, Bank.POINTER), key=lambda bank: votes[bank])
