"""Copies of values where paths join: what phis need at the ends of the blocks before them, as GCC's out-of-SSA pass makes them [tree-outof-ssa.cc]."""

from __future__ import annotations

import re

from bfsim.kernel.estimate.memory.predictive_commoning import ALONG
from bfsim.kernel.estimate.registers.webs import Webs
from bfsim.kernel.estimate.selection.constants import load_constant
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.ir.text import Instruction
from bfsim.kernel.operations import Op

DECLARED = re.compile(r"\.v(\d+)")
LAST = 1 << 16


class PhiCopies:
    """Inserts the copies into the code of a routine; `on_edges`: those that belong to an edge."""

    def __init__(self, webs: Webs) -> None:
        self.webs, self.flow, self.code = webs, webs.flow, webs.code
        self.find, self.bank = webs.find, webs.bank
        self.on_edges: dict[tuple[str, str], list[MachineInstruction]] = {}
        self._copies()

    def _copies(self) -> None:
        """Insert the copies that phis need at the ends of the blocks before them; values that swap places take a third register."""
        onto: dict[tuple[str, str], dict[str, str]] = {}
        for phi, arms in sorted(self.webs.phis.items(), key=lambda each: _declared(each[0])):
            home = self.flow.defined[phi][0]
            line = self.flow.defined[phi][1].line
            for value, label in arms:
                if value.startswith("#"):
                    self._on_edge(label, home, load_constant(value, line, phi, self.bank[self.find(phi)]))
                elif self.find(value) != self.find(phi):
                    move = MachineInstruction(
                        Op.MOVE, line, phi, RegisterBank.ANY, ((value, RegisterBank.ANY),)
                    )
                    if ALONG in phi and self._is_kept_apart(
                        value, self._following(value, label), label, home
                    ):
                        continue  # the copy for the next one also serves this one
                    if self._is_kept_apart(phi, value, label, home):
                        kept = MachineInstruction(
                            Op.MOVE, line, None, RegisterBank.ANY, ((phi, RegisterBank.ANY),)
                        )
                        self.code.add(home, kept)
                        continue
                    if self._is_before_the_test(phi, value, label, home):
                        self.code.add(label, move)
                        continue
                    self._on_edge(label, home, move)
                    onto.setdefault((label, home), {})[self.find(phi)] = self.find(value)
        for (label, home), copies in onto.items():
            if _is_circular(copies):
                line = self.flow.blocks[home].instructions[0].line
                self._on_edge(label, home, MachineInstruction(Op.MOVE, line, None, RegisterBank.ANY))

    def _is_kept_apart(self, phi: str, value: str, label: str, home: str) -> bool:
        """Whether the old value is copied in the header, before the new one is computed there [insert_backedge_copies].

        Then the two share a register, and nothing is copied on the back edge. It is copied if the old value is used
        after that or after the header, unless another variable takes it over. A carried value is copied even then, if
        GCC sees that it is taken over: not in a loop of one block with a variable before it, for which the statements
        have already been numbered.
        """
        where, new = self.flow.defined.get(value.removesuffix(".wide"), ("", None))
        critical = home in self.flow.dominators[label] and len(set(self.flow.blocks[label].successors)) > 1
        if new is None or not critical:
            return False
        if new.opcode == "phi":
            where = self._chosen_in(new)
        if where != home:
            return False
        rows = [id(each) for each in self.flow.blocks[home].instructions]
        places = [
            rows.index(id(each)) if id(each) in rows else len(rows) for each in self.flow.users.get(phi, [])
        ]
        if self._is_taken_over(phi, label):
            return ALONG in phi and not (label == home and self._is_numbered(phi, home))
        made = len(rows) - 1 if new.opcode == "phi" else rows.index(id(new))
        return any(place > made for place in places)

    def _chosen_in(self, phi: Instruction) -> str:
        """The block that computes a phi without a branch; empty for other phis."""
        conversions = self.webs.context.conversions_of(phi)
        is_one = len(conversions) == 1 and not self.webs.context.others(phi)
        return conversions[0].label if is_one else ""

    def _is_numbered(self, along: str, home: str) -> bool:
        """Whether a variable before `along` is used and recomputed in a loop of one block [maybe_renumber_stmts_bb]."""
        if f"{ALONG}0." not in along:
            return True  # the last one of the previous chain
        for phi in self.webs.phis:
            new = self.flow.instruction(self._following(phi, home).removesuffix(".wide"))
            if (
                ALONG not in phi
                and new is not None
                and new.opcode != "phi"
                and self.flow.defined[phi][0] == home
            ):
                return True
        return False

    def _following(self, phi: str, label: str) -> str:
        """The next value of a phi after block `label`; empty if the value is no phi."""
        return next((value for value, source in self.webs.phis.get(phi, ()) if source == label), "")

    def _is_taken_over(self, phi: str, label: str) -> bool:
        """Whether another variable gets the old value at the end of block `label`."""
        return any((phi, label) in arms for arms in self.webs.phis.values())

    def _is_before_the_test(self, phi: str, value: str, label: str, home: str) -> bool:
        """Whether the copy of a back edge is made before the test there [insert_backedge_copies, tree-outof-ssa.cc].

        It is, unless a variable that was declared later, or one that is carried along, takes over the old value in
        turn, or the old value is still used after the loop.
        """
        if label not in self.flow.blocks or home not in self.flow.dominators[label]:
            return False
        new = self.flow.instruction(value.removesuffix(".wide"))
        if ALONG in phi and new is not None and new.opcode != "phi" and self._is_taken_over(phi, label):
            return False
        later = (other for other in self.webs.phis if _declared(other) > _declared(phi))
        taken_over = any((phi, label) in self.webs.phis[other] for other in later)
        outside = (way for way in self.flow.blocks[label].successors if way != home)
        return not taken_over and not any(phi in self.webs.live.into[way] for way in outside)

    def _on_edge(self, label: str, home: str, instruction: MachineInstruction) -> None:
        ways = set(self.flow.blocks[label].successors)
        is_converted = home not in ways  # both sides of its branch led there, so it has none any more
        if is_converted or len(ways) == 1 or self._is_loaded_early(label, home, instruction):
            self.code.add(label, instruction)
        else:
            self.on_edges.setdefault((label, home), []).append(instruction)

    def _is_loaded_early(self, label: str, home: str, instruction: MachineInstruction) -> bool:
        """Whether a constant that one side of a test needs is loaded before its branch [find_if_case_1 in ifcvt.cc].

        It is if the condition was computed before the loop; otherwise that side runs too seldom.
        """
        others = (way for way in self.flow.blocks[label].successors if way != home)
        return (
            instruction.op in (Op.IMM, Op.MOVE)
            and self.webs.context.is_kept(self.flow.blocks[label])
            and home not in self.flow.dominators[label]
            and all(
                self.find(instruction.result or "") not in map(self.find, self.webs.live.into[way])
                for way in others
            )
        )


def _declared(phi: str) -> int:
    """The place of the declaration of a phi's variable, after those that have no name in the source."""
    found = DECLARED.search(phi)
    return int(found.group(1)) if found else LAST


def _is_circular(copies: dict[str, str]) -> bool:
    """Whether copied values form a circle, each ending up where another one came from."""
    for start, source in copies.items():
        name, seen = source, {start}
        while name in copies and name not in seen:
            seen.add(name)
            name = copies[name]
        if name == start:
            return True
    return False
