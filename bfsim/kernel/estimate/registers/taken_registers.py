"""How many registers of each bank are taken at once, and so how many a function saves; and which arguments stay on the stack.

A constant that is no immediate takes a register besides the operands of its instruction: from its first use in a block
to its last one, and throughout the loops that use it. The result may take the register of an operand that is no longer
needed; in a loop, not if the operand was moved to a pointer register for it [order_regs_for_reload in reload1.cc of GCC
12].

Saving one more register costs a store and a load. So if all others are taken, an argument on the stack that is seldom
used stays there, and is loaded wherever it is used [assign_hard_reg in ira-color.cc].
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping

from bfsim.kernel import operations
from bfsim.kernel.estimate.registers.pressure import POINTERS, Pressure
from bfsim.kernel.estimate.registers.webs import Webs
from bfsim.kernel.estimate.selection.iteration_counts import IterationCounts
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule

DATA, POINTER = RegisterBank.DATA, RegisterBank.POINTER
SCRATCH = {DATA: operations.SCRATCH_DATA_REGISTERS, POINTER: operations.SCRATCH_POINTER_REGISTERS}
AVAILABLE = {DATA: operations.DATA_REGISTERS, POINTER: POINTERS}
COUNTER = "count "
"""Begins the names of values that count iterations."""
SELDOM = 2
"""Uses per entry of the function: as many as the accesses that saving a register takes."""


class TakenRegisters:
    """The registers that are taken at each point of one routine."""

    def __init__(self, webs: Webs, pressure: Pressure) -> None:
        self.webs, self.flow, self.code, self.bank = webs, webs.flow, webs.code, webs.bank
        self.counts = IterationCounts(webs.context)
        self.in_loops = defaultdict[str, set[str]](set)
        """For each block: constants that loops around it keep in registers, loaded before the outermost one."""
        for loop in self.flow.loops:
            if self.flow.loops_of(loop.header)[-1] is loop:
                for label in self.flow.inside(loop):
                    self.in_loops[label] |= pressure.constants_in(loop).keys()
        self.on_stack = set(webs.context.parameters()[operations.REGISTER_ARGUMENTS :])
        self.staying: set[str] = set()
        """Arguments that stay on the stack."""
        if webs.context.profile.applies(Rule.ARGUMENT_LOADS):
            self.staying |= {name for name in self.on_stack if self._is_only_chosen(name)}
        if webs.context.profile.applies(Rule.STAYING_ARGUMENTS):
            for bank in (DATA, POINTER):
                self._leave(bank)

    def _is_only_chosen(self, name: str) -> bool:
        """Whether an argument's only use is a choice outside loops: it is loaded on the edge there [combine_and_move_insns in ira.cc]."""
        homes = [(phi, arm) for phi, arms in self.webs.phis.items() for arm in arms if arm[0] == name]
        uses = [
            each
            for block in self.code.of.values()
            for each in block
            if name in (used for used, _ in each.uses)
        ]
        is_once = len(dict(homes)) == 1 and all(each.op is Op.MOVE for each in uses)
        return is_once and all(self.flow.innermost(label) is None for _, (_, label) in homes)

    def most(self, bank: RegisterBank) -> int:
        """How many registers of a bank are taken at once."""
        return min(max(map(len, self._points(bank)), default=0), AVAILABLE[bank])

    def _points(self, bank: RegisterBank) -> list[set[str]]:
        """The values that take registers of a bank, at each point of the routine."""
        points = [
            taken | self.in_loops[label] | self._counters(label)
            for label in self.flow.blocks
            for taken in self._taken(label)
        ]
        of_bank = {name for name in set[str]().union(*points) if self._bank(name) is bank} - self.staying
        return [taken & of_bank for taken in points]

    def _counters(self, label: str) -> set[str]:
        """Counters of counted loops, which are in pointer registers until they become the hardware's [loop_end in bfin.md]."""
        if not self.webs.context.profile.applies(Rule.COUNTER_REGISTERS):
            return set()
        counted = self.webs.context.counters.counted
        return {f"{COUNTER}{each.header}" for each in self.flow.loops_of(label) if each.header in counted}

    def _counts(self, label: str) -> set[str]:
        """The values that take pointer registers while the number of iterations of the loop after a block is computed.

        The bound is moved to a register other than the result's [find_reg in reload1.cc].
        """
        found = set[str]()
        for loop in self.flow.loops if self.webs.context.profile.applies(Rule.SHIFTED_COUNTS) else ():
            if self.flow.entering(loop) == label and loop.header in self.webs.context.counters.counted:
                argument = self.counts.shifted_argument(loop)
                if argument is not None and self._bank(argument) is DATA:
                    found |= {f"{COUNTER}{loop.header}", f"{COUNTER}{argument}"}
                    found |= {
                        self._key(phi) for phi in self.webs.phis if self.flow.defined[phi][0] == loop.header
                    }
        return found

    def _bank(self, name: str) -> RegisterBank | None:
        if name.startswith(COUNTER):
            return POINTER
        return DATA if name.startswith("#") else self.bank.get(self.webs.find(name))

    def _key(self, name: str) -> str:
        """The owner of a register: a web, or an argument on the stack."""
        return name if name in self.on_stack else self.webs.find(name)

    def _taken(self, label: str) -> Iterator[set[str]]:
        """The values that take registers after and during each instruction of a block, the last one first."""
        alive = {self._key(name) for name in self.webs.live.out[label]}
        yield set(alive) | self._counts(label)
        in_loop = self.flow.innermost(label) is not None
        constants = self._constants(label)
        for number, instruction in reversed([*enumerate(self.code.of[label])]):
            behind = set(alive)
            if instruction.result:
                alive.discard(self._key(instruction.result))
            alive.update(self._key(name) for name, _ in instruction.uses if not name.startswith("#"))
            yield (
                set(alive)
                if in_loop
                else alive | {name for name, uses in constants.items() if number in uses}
            )
            if in_loop and (moved := self._kept_from_result(instruction)):
                yield behind | moved | {self._key(instruction.result or "")}

    def _constants(self, label: str) -> dict[str, range]:
        """Constants that a block keeps in registers, each with its first and last instruction: one that is used again stays [cse.cc]."""
        found: dict[str, range] = {}
        for number, instruction in enumerate(self.code.of[label]):
            for name in _constants(instruction):
                found[name] = range(found.get(name, range(number, 0)).start, number + 1)
        return found

    def _kept_from_result(self, instruction: MachineInstruction) -> set[str]:
        """Operands that were moved to a pointer register for a result in one."""
        if instruction.result is None or self._bank(instruction.result) is not POINTER:
            return set()
        return {self._key(name) for name, bank in instruction.uses if bank is POINTER and "@" in name}

    def _leave(self, bank: RegisterBank) -> None:
        """Leave the least used of the taken values on the stack while a register would be saved for one of them."""
        frequency = self._frequencies()
        while True:
            points = self._points(bank)
            most = max(map(len, points), default=0)
            if most <= SCRATCH[bank]:
                return
            able = set.intersection(*(self._last(taken, frequency) for taken in points if len(taken) == most))
            if not able:
                return
            self.staying.add(min(able, key=lambda name: (frequency[name], name)))

    def _last(self, taken: set[str], frequency: Mapping[str, float]) -> set[str]:
        """Arguments on the stack that get a register only after the others that are `taken`, and are seldom used."""
        rivals = (name for name in taken - self.on_stack if not name.startswith(COUNTER))
        others = min((frequency[name] for name in rivals), default=0.0)
        return {name for name in taken & self.on_stack if frequency[name] <= min(others, 1 + SELDOM)}

    def _frequencies(self) -> defaultdict[str, float]:
        """How often each owner of a register is computed or used per entry of the function."""
        found = defaultdict[str, float](float)
        for name in self.webs.context.parameters():
            found[self._key(name)] += 1
        for label, block in self.code.of.items():
            often = self.webs.frequency[label]
            for instruction in block:
                names = [self._key(name) for name, _ in instruction.uses if not name.startswith("#")]
                names += [self._key(instruction.result)] if instruction.result else []
                constants = [*_constants(instruction)] * 2
                for name in (*names, *constants):
                    found[name] += often
        for arms in self.webs.phis.values():
            for value, label in arms:
                if value in self.on_stack:
                    found[value] += self.webs.frequency[label]
        return found


def _constants(instruction: MachineInstruction) -> set[str]:
    """Constants that an instruction needs in registers."""
    if instruction.op is Op.IMM:
        return set()
    return {
        name
        for name, bank in instruction.uses
        if name.startswith("#") and name != "#poison" and bank is not POINTER
    }
