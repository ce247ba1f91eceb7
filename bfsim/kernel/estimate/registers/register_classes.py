"""Register classes: the bank in which GCC keeps the values of a chain of sums, by the two passes of find_costs_and_classes (ira-costs.cc of GCC 12).

An addition can also be done in an I register, I0 += M0 [addsi3 in bfin.md]. So the first pass finds that a sum that is
only added to costs nothing in the class IPREGS, which has no data registers, and to the second pass an addition on data
registers needs a move. A value that may be in either bank, such as a loaded word, then goes to a pointer register; the
sum itself ends up in a data register. But a value that a load without a step loads for a single use stays in memory
until then, so that no register has to be saved for it [update_equiv_regs in ira.cc].
"""

from __future__ import annotations

from collections import Counter as Tally
from collections import defaultdict
from dataclasses import dataclass, field

from bfsim.kernel import operations
from bfsim.kernel.estimate.registers.webs import Webs
from bfsim.kernel.estimate.selection.constants import BOUND
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.operations import Op

ANY, DATA, POINTER = RegisterBank.ANY, RegisterBank.DATA, RegisterBank.POINTER
PASSING = {Op.MOVE, Op.IMM, Op.IMM32}
"""Operations for which any register will do."""
TIED = {Op.ALU: 2, Op.COMPARE: 2, Op.ADD_SHIFT: 2, Op.SHIFT: 1}
"""Operations whose operands must all be in one bank, if there are that many."""


@dataclass(slots=True)
class _Value:
    """The instructions that use and compute a value, by the bank that it must be in there."""

    strict: Tally[RegisterBank] = field(default_factory=Tally)
    is_plain: bool = False
    """Whether something other than a sum uses or computes it in either bank."""
    is_sum: bool = False
    is_merged: bool = False
    """Whether it is something other than one loaded word or one sum."""

    @property
    def is_between(self) -> bool:
        """Whether it is a sum that is only added to: the first pass finds IPREGS best."""
        return self.is_sum and not self.is_plain and not self.strict

    @property
    def is_free(self) -> bool:
        """Whether it is a word or a sum that may be in either bank, and the first pass finds DPREGS best."""
        return not self.strict and not self.is_between and not self.is_merged


class RegisterClasses:
    """Puts the values that chains of sums of one routine add into the banks where GCC has them."""

    def __init__(self, webs: Webs) -> None:
        self.webs, self.flow, self.code = webs, webs.flow, webs.code
        self.values: defaultdict[str, _Value] = defaultdict(_Value)
        self.costs: defaultdict[str, Tally[RegisterBank]] = defaultdict(Tally)
        self.behind: defaultdict[str, set[str]] = defaultdict(set)
        """The sums of each value that is added in a chain."""
        self.waiting: set[str] = set()
        """Words that may stay in memory until they are used."""
        for label in self.flow.order:
            for instruction in self.code.of[label]:
                self._note(instruction, int(webs.frequency[label] * 1000) + 1)
                if self._may_wait(instruction, label):
                    self.waiting.add(webs.find(instruction.result or ""))
        for label in self.flow.order:
            for instruction in filter(self.is_sum, self.code.of[label]):
                self._note_bytes(instruction)

    def _note_bytes(self, instruction: MachineInstruction) -> None:
        """Note that sums of bytes or half-words are best in data registers, where these are."""
        names = [self.webs.find(name) for name, _ in instruction.uses if not name.startswith("#")]
        total = self.webs.find(instruction.result or "")
        if total in names and any(self.values[name].strict[DATA] for name in names):
            self.values[total].is_plain = True

    def _steps(self, instruction: MachineInstruction) -> bool:
        """Whether an instruction adds a number to a variable, which either bank can do."""
        names = [self.webs.find(name) for name, _ in instruction.uses if not name.startswith("#")]
        is_either = instruction.bank is ANY and all(bank is ANY for _, bank in instruction.uses)
        return instruction.op is Op.ALU and is_either and names == [self.webs.find(instruction.result or "")]

    def _may_wait(self, instruction: MachineInstruction, label: str) -> bool:
        """Whether an instruction loads a word by a pointer that it does not step, and the word has a single use, later in its block."""
        access = instruction.access
        if instruction.op is not Op.LOAD32 or access is None:
            return False
        variable = self.webs.context.induction_variables.of.get(id(access))
        stepping = variable.stepping if variable is not None and variable.steps_free else None
        users = self.flow.users.get(access.result or "", [])
        return (
            (stepping is None or stepping.instruction is not access)
            and len(users) == 1
            and self.flow.defined.get(users[0].result or "", ("",))[0] == label
        )

    def is_sum(self, instruction: MachineInstruction) -> bool:
        """Whether an instruction adds two values that may be in either bank."""
        made_for = self.flow.instruction(instruction.result or "")
        return (
            instruction.op is Op.ALU
            and instruction.bank is ANY
            and [bank for _, bank in instruction.uses] == [ANY, ANY]
            and made_for is not None
            and made_for.opcode == "add"
        )

    def _note(self, instruction: MachineInstruction, weight: int) -> None:
        if instruction.op is Op.IMM or self._steps(instruction):
            return
        is_sum, find = self.is_sum(instruction), self.webs.find
        for name, bank in instruction.uses:
            if not name.startswith("#") and bank is not ANY:
                self.values[find(name)].strict[bank] += weight
            elif not name.startswith("#") and not is_sum and instruction.op not in PASSING:
                self.values[find(name)].is_plain = True
        if not instruction.result:
            return
        result = self.values[find(instruction.result)]
        result.is_sum |= is_sum
        result.is_merged |= not is_sum and instruction.op is not Op.LOAD32
        if instruction.bank is not ANY:
            result.strict[instruction.bank] += weight
        elif not is_sum and instruction.op not in PASSING:
            result.is_plain = True

    def place(self) -> None:
        """Put each value that chains of sums add into the bank that costs less in the second pass, if a register is left."""
        for label in self.flow.order:
            for instruction in self.code.of[label]:
                self._second_pass(instruction, int(self.webs.frequency[label] * 1000) + 1)
        for web, value in self.values.items():
            if value.is_between:
                self.webs.bank[web] = DATA
        self._place_bounds()
        room = _Room(self.webs)
        gains = {web: self.costs[web][DATA] - self.costs[web][POINTER] for web in self.behind}
        for web in sorted(gains, key=lambda web: (-gains[web], web)):
            if gains[web] > 0 and self.values[web].is_free:
                self._to_pointers(web, room)
        for web in sorted(gains, reverse=True):  # if either costs the same, it is where the next sum is
            if (
                gains[web] == 0
                and self.values[web].is_between
                and {self.webs.bank[other] for other in self.behind[web]} == {POINTER}
            ):
                self._to_pointers(web, room)

    def _place_bounds(self) -> None:
        """Put each number that is loaded for a comparison into the bank of the value that it is compared with."""
        bank, find = self.webs.bank, self.webs.find
        for instruction in (each for label in self.flow.order for each in self.code.of[label]):
            if instruction.op is Op.COMPARE and len(instruction.uses) == 2:
                (compared, _), (bound, _) = instruction.uses
                if bound.endswith(BOUND) and find(compared) in bank:
                    bank[find(bound)] = bank[find(compared)]

    def _second_pass(self, instruction: MachineInstruction, weight: int) -> None:
        """Add the cost of an operation to its values in each bank, in moves; note what follows those of a chain."""
        webs = self._tied(instruction)
        if self.is_sum(instruction) and any(self.values[web].is_between for web in webs):
            for web in webs:
                self.behind[web] |= {self.webs.find(instruction.result or "")} - {web}
        moves = {bank: sum(self._excludes(web, bank) for web in webs) for bank in (DATA, POINTER)}
        for web in webs:
            self.costs[web][DATA] += weight * min(moves[DATA], moves[POINTER] + 1)
            more = self.values[web].is_between  # from IPREGS, it takes one more move
            self.costs[web][POINTER] += weight * (min(moves[POINTER], moves[DATA] + 1) + more)

    def _to_pointers(self, web: str, room: _Room) -> None:
        value = self.values[web]
        may_be = value.is_free or value.is_between
        if may_be and self.webs.bank[web] is DATA and room.has(web, saves=web not in self.waiting):
            self.webs.bank[web] = POINTER

    def _tied(self, instruction: MachineInstruction) -> set[str]:
        """The webs of an operation whose operands must all be in one bank."""
        either = [name for name, bank in instruction.uses if bank is ANY]
        least = TIED.get(instruction.op)
        if least is None or len(either) != len(instruction.uses) or len(either) < least:
            return set()
        result = [instruction.result] if instruction.result and instruction.bank is ANY else []
        return {self.webs.find(name) for name in (*either, *result) if not name.startswith("#")}

    def _excludes(self, web: str, bank: RegisterBank) -> bool:
        """Whether the class that the first pass finds best for a value has no register of a bank."""
        value = self.values[web]
        if value.is_between:
            return bank is DATA
        return not value.is_free and self.webs.bank[web] is not bank


class _Room:
    """The number of pointer registers taken at each point of a routine, counters of counted loops included."""

    def __init__(self, webs: Webs) -> None:
        self.webs = webs
        counted = webs.context.counters.counted
        self.points: list[tuple[set[str], int]] = []
        for label in webs.flow.order:
            counters = sum(loop.header in counted for loop in webs.flow.loops_of(label))
            alive = {webs.find(name) for name in webs.live.out[label]}
            self.points.append((set(alive), counters))
            for instruction in reversed(webs.code.of[label]):
                if instruction.result:
                    alive.discard(webs.find(instruction.result))
                alive.update(webs.find(name) for name, _ in instruction.uses if not name.startswith("#"))
                self.points.append((set(alive), counters))

    def has(self, web: str, *, saves: bool) -> bool:
        """Whether a pointer register is free wherever a value is alive; without `saves`, one that needs no saving or is taken elsewhere."""
        taken = [
            (web in alive, sum(self.webs.bank.get(name) is POINTER for name in alive) + counters)
            for alive, counters in self.points
        ]
        most = max(operations.SCRATCH_POINTER_REGISTERS, *(number for _, number in taken))
        room = operations.POINTER_REGISTERS + 1 if saves else most
        return all(number < room for is_alive, number in taken if is_alive)
