"""Webs: values that share one register, and the bank in which each of them lives."""

from __future__ import annotations

from collections import Counter as Tally
from collections import defaultdict

from bfsim.kernel.estimate.induction_variables.induction_variables import is_merged_pointer
from bfsim.kernel.estimate.registers.liveness import Liveness, liveness
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.machine_code import MachineCode, MachineInstruction, RegisterBank
from bfsim.kernel.ir.text import each_arm
from bfsim.kernel.rules import Rule

ROUNDS = 3  # in which values settle in the bank of the other operands


class Webs:
    """The webs of one routine. A phi and its arms are one web, unless some of its values are alive together."""

    def __init__(self, context: Context, code: MachineCode) -> None:
        self.context, self.flow, self.code = context, context.flow, code
        self.frequency = context.likelihood.frequency
        self.phis = self._phis()
        self.web: dict[str, str] = {}
        self.bank: dict[str, RegisterBank] = {}
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
                conversions = self.context.conversions_of(each)
                others = self.context.others(each)
                is_one = len(conversions) == 1 and not others
                if (
                    each.opcode == "phi"
                    and not is_merged_pointer(each)
                    and self.context.demanded.emits(each)
                    and not is_one
                ):
                    found[each.result or ""] = [
                        (self.context.chosen(each, value), label)
                        for value, label in others
                        if value != "poison"
                    ] + [(self.context.converted(conversion), conversion.label) for conversion in conversions]
        return found

    def analyse(self) -> None:
        """Find the live values; call again whenever instructions were inserted."""
        merged = {
            phi: [(value, label) for value, label in arms if not value.startswith("#")]
            for phi, arms in self.phis.items()
        }
        self.live = liveness(self.flow, self.code, merged)

    def find(self, name: str) -> str:
        """The web that a value belongs to: values that share a register."""
        while self.web.get(name, name) != name:
            name = self.web[name]
        return name

    def _coalesce(self) -> None:
        """Give a phi and its arms one register, the most frequent copies first, unless both are live at once."""
        apart = self._interference()
        for phi, value in self._stepped() if self.context.profile.applies(Rule.STEPPED_COUNTERS) else ():
            apart[phi].discard(value)
            apart[value].discard(phi)
        members = {name: {name} for name in apart}
        copies = self._copies()
        merged = {copy for copy in copies if self._is_merged(*copy)}
        for phi, value in sorted(copies, key=lambda copy: (copy not in merged, -copies[copy])):
            one, other = self.find(phi), self.find(value)
            mine, theirs = members.setdefault(one, {one}), members.setdefault(other, {other})
            if one == other or any(not apart[name].isdisjoint(theirs) for name in mine):
                continue
            self.web[other] = one
            mine |= theirs

    def _is_merged(self, phi: str, value: str) -> bool:
        """Whether a value is chosen only for another phi, in a block without code: GCC merges it into that phi [pass_merge_phi in tree-cfgcleanup.cc]."""
        home, made = self.flow.defined.get(value, ("", None))
        block = self.flow.blocks.get(home)
        return (
            made is not None
            and block is not None
            and made.opcode == "phi"
            and self.flow.users[value] == [self.flow.defined[phi][1]]
            and block.successors == (self.flow.defined[phi][0],)
            and all(each.opcode == "phi" for each in block.instructions[:-1])
        )

    def _copies(self) -> dict[tuple[str, str], float]:
        """The cost of copying a value to a phi, summed over all edges; twice if an edge needs a block [coalesce_cost_edge in tree-ssa-coalesce.cc].

        GCC 12 decides before an `if` becomes branchless, so the edges through one count, too.
        """
        found: defaultdict[tuple[str, str], float] = defaultdict(float)
        taken, before = self.context.likelihood.taken, self.flow.predecessors
        for phi, arms in self.phis.items():
            home, each = self.flow.defined[phi]
            known = [(self.context.name(value), label) for value, label in each_arm(each)]
            for value, label in dict.fromkeys((*arms, *known)):
                if value.startswith("#") or (label, home) not in taken:
                    continue
                is_critical = len(set(self.flow.blocks[label].successors)) > 1 and len(before[home]) > 1
                found[phi, value] += self.frequency[label] * taken[label, home] * (2 if is_critical else 1)
        return found

    def _stepped(self) -> list[tuple[str, str]]:
        """Counters of loops and their next values, which only the next iteration uses: they are stepped last, in place."""
        found = []
        for phi, arms in self.phis.items():
            label, each = self.flow.defined[phi]
            latches = [loop.latch for loop in self.flow.loops if loop.header == label]
            for value, source in arms:
                instruction = self.flow.instruction(value)
                advances = (
                    instruction is not None and instruction.opcode == "add" and instruction.operands[0] == phi
                )
                if advances and source in latches and self.flow.users[value] == [each]:
                    found.append((phi, value))
        return found

    def _interference(self) -> defaultdict[str, set[str]]:
        """For each value: those that are alive where it is computed, or that are computed while it is alive."""
        apart: defaultdict[str, set[str]] = defaultdict(set)

        def keep_apart(name: str, alive: set[str]) -> None:
            apart[name] |= alive - {name}
            for other in alive - {name}:
                apart[other].add(name)

        entry = self.flow.routine.blocks[0].label
        for label in self.flow.order:
            alive = set(self.live.out[label])
            for instruction in reversed(self.code.of[label]):
                if instruction.result:
                    keep_apart(instruction.result, alive)
                    alive.discard(instruction.result)
                alive.update(name for name, _ in instruction.uses if not name.startswith("#"))
            here = {phi for phi in self.phis if self.flow.defined[phi][0] == label}
            for name in alive if label == entry else here:
                keep_apart(name, alive | here)
        return apart

    def _choose_banks(self) -> None:
        """Choose the bank that needs fewer moves, if a value's definition leaves the choice."""
        fixed, wants, friends = self._wishes()
        names = {self.find(each) for each in self._names()}
        self.bank = {name: _majority(fixed.get(name)) or RegisterBank.DATA for name in names}
        for _ in range(ROUNDS):
            for name in sorted(names - fixed.keys()):
                votes = Tally(wants.get(name, Tally()))
                for friend, weight in friends.get(name, Tally()).items():
                    if friend != name and (friend in fixed or friend in wants):
                        votes[self.bank[friend]] += weight // 2
                self.bank[name] = _majority(votes) or RegisterBank.DATA

    def _names(self) -> set[str]:
        instructions = [instruction for block in self.code.of.values() for instruction in block]
        return (
            {name for instruction in instructions for name, _ in instruction.uses}
            | {instruction.result for instruction in instructions if instruction.result}
            | {*self.phis}
        )

    def _wishes(
        self,
    ) -> tuple[dict[str, Tally[RegisterBank]], dict[str, Tally[RegisterBank]], dict[str, Tally[str]]]:
        """For each web: banks that its definitions fix, banks that its uses want, and webs it is computed with."""
        fixed: defaultdict[str, Tally[RegisterBank]] = defaultdict(Tally)
        wants: defaultdict[str, Tally[RegisterBank]] = defaultdict(Tally)
        friends: defaultdict[str, Tally[str]] = defaultdict(Tally)
        for label, block in self.code.of.items():
            weight = int(self.frequency[label] * 1000) + 1
            for instruction in block:
                own = self.find(instruction.result) if instruction.result else None
                from_data = self._subtracts(instruction)
                if from_data and own:
                    wants[own][RegisterBank.DATA] += weight
                if own and instruction.bank is not RegisterBank.ANY:
                    fixed[own][instruction.bank] += weight
                for name, bank in instruction.uses:
                    other = self.find(name)
                    if bank is not RegisterBank.ANY and not name.startswith("#"):
                        wants[other][bank] += weight
                    elif from_data:
                        wants[other][RegisterBank.DATA] += weight
                    elif own and not name.startswith("#"):
                        friends[other][own] += weight
                        friends[own][other] += weight
        return fixed, wants, friends

    def _subtracts(self, instruction: MachineInstruction) -> bool:
        """Whether it subtracts two values into a third, which only data registers can do [subsi3 in bfin.md]."""
        made_for = self.flow.instruction(instruction.result or "")
        names = [name for name, _ in instruction.uses]
        return (
            made_for is not None
            and made_for.opcode == "sub"
            and instruction.bank is RegisterBank.ANY
            and len(names) == 2
            and not any(each.startswith("#") for each in names)
            and self.find(names[0]) != self.find(instruction.result or "")
        )


def _majority(votes: Tally[RegisterBank] | None) -> RegisterBank | None:
    if not votes:
        return None
    return max((RegisterBank.DATA, RegisterBank.POINTER), key=lambda bank: votes[bank])
