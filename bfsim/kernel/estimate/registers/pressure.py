"""Register pressure: values that do not fit in the registers of a loop are reloaded where they are used.

The value to go is the one used least for the room it takes, which is the number of crowded places where it is alive
[allocno_spill_priority in ira-color.cc of GCC 12].

Values come from the stack; constants from registers that can do nothing else (I, M, B), which takes a move. A sum that
is only added to stays in an I register: the addend moves to an M register, I0 += M0 [addsi3 in bfin.md]. That there are
only four of these is ignored.
"""

from __future__ import annotations

from collections import Counter as Tally
from collections import defaultdict
from functools import cached_property

from bfsim.kernel import operations
from bfsim.kernel.estimate.registers.either_bank import tied_webs
from bfsim.kernel.estimate.registers.webs import Webs
from bfsim.kernel.estimate.selection.constants import load_constant
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.ir.control_flow import Loop
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule

POINTERS = operations.POINTER_REGISTERS + 1  # with FP, which -O2 frees
KEPT = {RegisterBank.DATA: 4, RegisterBank.POINTER: 4}  # R4-R7, P3-P5 and FP survive a call
ROOM = {RegisterBank.DATA: operations.DATA_REGISTERS, RegisterBank.POINTER: POINTERS}


class Pressure:
    """Inserts the reloads into the code of a routine."""

    def __init__(self, webs: Webs) -> None:
        self.webs, self.flow, self.code = webs, webs.flow, webs.code
        self.find, self.bank, self.frequency = webs.find, webs.bank, webs.frequency
        self.reloading: set[tuple[str, RegisterBank]] = set()
        webs.analyse()
        self._spill()

    def _spill(self) -> None:
        """Spill in the innermost loops first: the value used least there gives up its register."""
        spilled: set[str] = set()
        for loop in self.flow.loops:
            for bank in (RegisterBank.DATA, RegisterBank.POINTER):
                for _ in range(32):
                    crowded = self._crowded(loop, bank, spilled)
                    if not crowded:
                        break
                    if self._gives_way(crowded, bank):
                        continue
                    victim = self._victim(loop, bank, spilled, crowded)
                    spilled.add(victim)
                    self._reload(victim, loop)

    def _gives_way(self, crowded: list[set[str]], bank: RegisterBank) -> bool:
        """Move one value of a full bank to the other one, if that costs nothing; return whether there was one."""
        if not self.webs.context.profile.applies(Rule.EITHER_BANK):
            return False
        other = RegisterBank.DATA if bank is RegisterBank.POINTER else RegisterBank.POINTER
        names = Tally(name for here in crowded for name in here if name not in self.tied)
        for name in sorted(names, key=lambda name: (-names[name], name)):
            if self._has_room(name, other):
                self.bank[name] = other
                return True
        return False

    @cached_property
    def tied(self) -> frozenset[str]:
        """Webs that must be in their bank."""
        return tied_webs(self.webs)

    def _has_room(self, web: str, bank: RegisterBank) -> bool:
        """Whether a register of a bank is free wherever a web is alive."""
        constants = {name for loop in self.flow.loops for name in self._constants(loop, bank, set())}
        for label in self.flow.order:
            loops = self.flow.loops_of(label)
            counters = self._counters(label, loops[-1]) if loops and bank is RegisterBank.POINTER else 0
            for alive in self.points(label, across_calls=False):
                taken = sum(self.bank.get(name) is bank for name in alive)
                if web in alive and taken + counters + len(constants) >= ROOM[bank]:
                    return False
            if any(web in alive for alive in self.points(label, across_calls=True)):
                return False
        return True

    def constants_in(self, loop: Loop) -> dict[str, float]:
        """Return the constants that a loop keeps in registers, and how often it uses them."""
        found: dict[str, float] = {}
        for label in self.flow.inside(loop):
            for instruction in self.code.of[label]:
                for name, _ in instruction.uses:
                    if name.startswith("#") and instruction.op is not Op.IMM:
                        found[name] = found.get(name, 0) + self.frequency[label]
        return found

    def _victim(self, loop: Loop, bank: RegisterBank, spilled: set[str], crowded: list[set[str]]) -> str:
        """The value used least in relation to the crowded places where it is alive."""
        constants = self._constants(loop, bank, spilled)
        places = Tally(name for here in crowded for name in here) + Tally(
            dict.fromkeys(constants, len(crowded))
        )
        if not self.webs.context.profile.applies(Rule.SPILLED_RANGES):
            busiest = max(crowded, key=len)
            places = Tally(dict.fromkeys([*busiest, *constants], 1))
        used = self._weights(loop)
        weights = {name: constants.get(name, 0) or used[name] for name in places}
        victim = min(weights, key=lambda name: (weights[name] / (places[name] + 1), name))
        if weights[victim] or not self.webs.context.profile.applies(Rule.COUNTER_REGISTERS):
            self.reloading.add((loop.header, bank))
        return victim

    def _constants(self, loop: Loop, bank: RegisterBank, spilled: set[str]) -> dict[str, float]:
        """The constants that a loop keeps in registers of a bank."""
        if bank is not RegisterBank.DATA:
            return {}
        return {name: weight for name, weight in self.constants_in(loop).items() if name not in spilled}

    def _crowded(self, loop: Loop, bank: RegisterBank, spilled: set[str]) -> list[set[str]]:
        """The values alive in a bank, at each place of a loop where they are too many."""
        extra = len(self._constants(loop, bank, spilled))
        has_call = any(
            instruction.op is Op.CALL
            for label in self.flow.inside(loop)
            for instruction in self.code.of[label]
        )
        room = KEPT[bank] if has_call else ROOM[bank]
        # once something is spilled, one register is taken by the reloads
        reloading = (loop.header, bank) in self.reloading and self.webs.context.profile.applies(
            Rule.RELOAD_REGISTER
        )
        crowded: list[set[str]] = []
        for label in self.flow.inside(loop):
            counters = self._counters(label, loop) if bank is RegisterBank.POINTER else 0
            for alive in self.points(label, across_calls=has_call):
                here = {name for name in alive if self.bank.get(name) is bank and name not in spilled}
                if len(here) + extra + counters > room - reloading:
                    crowded.append(here)
        return crowded

    def _counters(self, label: str, loop: Loop) -> int:
        """Pointer registers that counters of counted loops take in a block, from `loop` inwards [loop_end in bfin.md]."""
        if not self.webs.context.profile.applies(Rule.COUNTER_REGISTERS):
            return 0
        counted = self.webs.context.counters.counted
        return sum(
            each.header in counted and each.blocks <= loop.blocks for each in self.flow.loops_of(label)
        )

    def points(self, label: str, *, across_calls: bool) -> list[set[str]]:
        """Webs alive after each instruction of a block (only across calls, if asked for)."""
        alive = {self.find(name) for name in self.webs.live.out[label]}
        found = [] if across_calls else [set(alive)]
        for instruction in reversed(self.code.of[label]):
            if instruction.result:
                alive.discard(self.find(instruction.result))
            if (
                across_calls and instruction.op is Op.CALL and instruction.code_bytes
            ):  # not those that a library routine calls
                found.append(set(alive))
            alive.update(self.find(name) for name, _ in instruction.uses if not name.startswith("#"))
            if not across_calls:
                found.append(set(alive))
        return found

    def _weights(self, loop: Loop) -> defaultdict[str, float]:
        """How often a loop computes or uses each web."""
        found = defaultdict[str, float](float)
        for label in self.flow.inside(loop):
            for instruction in self.code.of[label]:
                names = {self.find(name) for name, _ in instruction.uses}
                for name in names | {self.find(instruction.result or "")}:
                    found[name] += self.frequency[label]
        return found

    def _reload(self, web: str, loop: Loop) -> None:
        for label in self.flow.inside(loop):
            block: list[MachineInstruction] = []
            for instruction in self.code.of[label]:
                if self._adds_to(web, instruction):
                    block.append(MachineInstruction(Op.MOVE, instruction.line, None, RegisterBank.ANY))
                    block.append(instruction)
                    continue
                if (
                    any(self.find(name) == web for name, _ in instruction.uses)
                    and instruction.op is not Op.IMM
                ):
                    if (
                        block
                        and _is_copy_for(block[-1], instruction)
                        and web in map(self.find, instruction.overwrites)
                    ):
                        block.pop()  # a reloaded value may be overwritten
                    block.append(self._reloading(web, instruction))
                block.append(instruction)
                if instruction.result and self.find(instruction.result) == web:
                    block.append(MachineInstruction(Op.STORE32, instruction.line, None, RegisterBank.ANY))
            self.code.of[label] = block

    def _adds_to(self, web: str, instruction: MachineInstruction) -> bool:
        """Whether an instruction adds another value to the sum in `web`."""
        result = instruction.result or ""
        made_for = self.flow.instruction(result)
        return (
            self.webs.context.profile.applies(Rule.SPILLED_SUMS)
            and instruction.op is Op.ALU
            and self.find(result) == web
            and made_for is not None
            and made_for.opcode == "add"
            and sum(self.find(name) == web for name, _ in instruction.uses) == 1
            and not any(name.startswith("#") for name, _ in instruction.uses)
        )

    def _reloading(self, web: str, instruction: MachineInstruction) -> MachineInstruction:
        """The operation that brings a value, or a constant, to where an instruction uses it."""
        constant = web.startswith("#")
        if constant and not self.webs.context.profile.applies(Rule.CONSTANT_MOVES):
            return load_constant(web, instruction.line)
        return MachineInstruction(
            Op.MOVE if constant else Op.LOAD32, instruction.line, None, RegisterBank.ANY
        )


def _is_copy_for(before: MachineInstruction, instruction: MachineInstruction) -> bool:
    """Whether the previous instruction only saves an operand that this one overwrites."""
    return bool(instruction.overwrites) and before.op is Op.MOVE and before.result is None and not before.uses
