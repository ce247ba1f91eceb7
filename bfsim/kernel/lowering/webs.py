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
    """The webs of one routine. A phi and its arms are one web, unless they are alive together."""

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
            if block.label in self.context.bit_counts:
                continue
            for each in block.instructions:
                if (
                    each.opcode == "phi"
                    and not is_merged_pointer(each)
                    and self.context.needs.emits(each)
                    and self.context.shape_of(each) is None
                ):
                    found[each.result or ""] = [
                        (self.context.name(value), label)
                        for value, label in self.context.arms(each)
                        if value != "poison"
                    ]
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
        for phi, arms in self.phis.items():
            for value, label in arms:
                if not value.startswith("#") and not self._clash(phi, value, label):
                    self.web[self.find(value)] = self.find(phi)

    def _clash(self, phi: str, value: str, label: str) -> bool:
        """Whether a phi and one of its arms are alive together, so that they need two registers."""
        home = self.flow.defined[phi][0]
        if value in self.live.into[home] or self.find(value) == self.find(phi):
            return value in self.live.into[home]
        place = self._place(value)
        if place is None:
            return phi in self.live.out[label] and phi not in self.live.into[home]
        if phi in self.live.out[place]:
            return True
        behind = False
        for step in self.steps.of[place]:
            if behind and any(name == phi for name, _ in step.uses):
                return True
            behind |= step.result == value
        return any(other == value for other_phi, other_arms in self.phis.items() if other_phi != phi
                   and self.flow.defined[other_phi][0] == home for other, source in other_arms if source == label)  # fmt: skip

    def _place(self, value: str) -> str | None:
        if value in self.flow.defined:
            return self.context.places.of.get(value)
        return None

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
