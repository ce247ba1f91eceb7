"""A register for each web, by what its class costs; who chooses first is who is hard to place, or frequent [ira-color.cc of GCC 12]."""

from __future__ import annotations

from collections import defaultdict

from bfsim.kernel.isa import Op
from bfsim.kernel.lowering.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.lowering.register_classes import MEMORY, MOVE, RegisterClasses
from bfsim.kernel.lowering.webs import Webs

BESIDE = (RegisterBank.INDEX, RegisterBank.BASE, RegisterBank.MODIFY)
REGISTERS = {
    **dict.fromkeys(("R0", "R1", "R2", "R3", "R7", "R6", "R5", "R4"), RegisterBank.DATA),
    **dict.fromkeys(("P2", "P1", "P0", "P5", "P4", "P3", "FP"), RegisterBank.POINTER),
    **{f"{bank.value}{number}": bank for bank in BESIDE for number in range(4)},
}  # in the order in which they are taken [REG_ALLOC_ORDER in bfin.h]
SAVED = {"R7", "R6", "R5", "R4", "P5", "P4", "P3", "FP"}
"""What a function that changes them saves, and calls keep."""
SAVING = 2 * MEMORY - 1  # of a saved register that is not used yet, in units of GCC's frequencies
MOST_FREQUENT = 1000  # of GCC's frequencies [REG_FREQ_MAX]
SHUFFLE = 8  # by how much less a register is wanted of an operand that ends than of one that is overwritten


class Colouring:
    """The `register` of each web, or None for memory."""

    def __init__(self, webs: Webs) -> None:
        self.webs, self.frequency = webs, webs.frequency
        self.classes = RegisterClasses(webs)
        self.conflicts = webs.conflicts()
        self.crossing = self._crossing()
        self.copies = self._copies()
        self.register: dict[str, str | None] = {}
        for name in self._order():
            self._assign(name)
        webs.bank = {name: _bank_of(register) for name, register in self.register.items()}

    def _crossing(self) -> dict[str, float]:
        """How often each web is alive across a call."""
        found: defaultdict[str, float] = defaultdict(float)
        for label in self.webs.code.of:
            for instruction, alive in self.webs.backwards(label):
                for name in alive - {*self.webs.results(instruction)} if is_call(instruction) else ():
                    found[name] += self.frequency[label]
        return found

    def _copies(self) -> dict[str, dict[str, float]]:
        """How often webs would like to share a register: of a copy, of what is overwritten, of what ends where another one begins."""
        found: defaultdict[str, dict[str, float]] = defaultdict(lambda: defaultdict(float))
        for label in self.webs.code.of:
            for instruction, alive in self.webs.backwards(label):
                names = self.webs.inputs(instruction)
                over = {self.webs.find(name) for name in instruction.overwrites}
                for own in self.webs.results(instruction):
                    for name in {*names} - alive - {own}:
                        bound = instruction.op is Op.MOVE or name in over
                        weight = self.frequency[label] / (1 if bound else SHUFFLE)
                        found[own][name] += weight
                        found[name][own] += weight
        return found

    def _threads(self) -> dict[str, str]:
        """Webs that are assigned one after the other, for they are joined by copies and never alive together."""
        thread = {name: name for name in self.webs.names()}
        members = {name: {name} for name in thread}
        pairs = {(min(one, other), max(one, other)) for one in self.copies for other in self.copies[one]}
        for one, other in sorted(pairs, key=lambda pair: (-self.copies[pair[0]][pair[1]], pair)):
            first, second = thread[one], thread[other]
            if first == second or any(self.conflicts[name] & members[second] for name in members[first]):
                continue
            members[first] |= members.pop(second)
            thread.update(dict.fromkeys(members[first], first))
        return thread

    def _order(self) -> list[str]:
        """Who chooses first. One after the other is put aside as soon as it is sure to find a register, the least frequent thread first.

        Those that are alive together with many others wait until enough of them are gone, so that they choose before these.
        """
        thread, number, frequency = self._threads(), self._numbers(), self.classes.memory
        together: defaultdict[str, float] = defaultdict(float)
        first: dict[str, int] = {}
        for name in thread:
            together[thread[name]] += frequency[name]
            first[thread[name]] = min(number[name], first.get(thread[name], number[name]))
        left = dict.fromkeys(sorted(thread, key=lambda name: number[name]))
        conflicts = {name: len(self.conflicts[name]) for name in left}
        aside: list[str] = []
        while left:
            sure = [name for name in left if conflicts[name] < len(REGISTERS)]
            following = min(
                sure or left,
                key=lambda name: (
                    (together[thread[name]], -first[thread[name]], frequency[name], -number[name])
                    if sure
                    else (frequency[name] / (conflicts[name] + 1), number[name])
                ),
            )
            del left[following]
            aside.append(following)
            for other in self.conflicts[following]:
                conflicts[other] -= 1
        return aside[::-1]

    def _numbers(self) -> dict[str, int]:
        """GCC numbers values as it meets them from the end of each block."""
        found: dict[str, int] = {}
        for label in self.webs.flow.order:
            for instruction, _ in self.webs.backwards(label):
                for name in (*self.webs.results(instruction), *self.webs.inputs(instruction)):
                    found.setdefault(name, len(found))
        for name in self.webs.names():
            found.setdefault(name, len(found))
        return found

    def _assign(self, name: str) -> None:
        """Take the cheapest register that nothing alive at the same time is in, unless memory is cheaper."""
        taken = {self.register.get(other) for other in self.conflicts[name]}
        wanted: defaultdict[str | None, float] = defaultdict(float)
        for other, weight in self.copies.get(name, {}).items():
            wanted[self.register.get(other)] += MOVE * weight
        costs = {
            register: self._saving(name, register) + self.classes.of[name][bank] - wanted[register]
            for register, bank in REGISTERS.items()
            if register not in taken
        }
        best = min(costs, key=lambda register: costs[register], default=None)
        self.register[name] = best if best and costs[best] <= self.classes.memory[name] else None

    def _saving(self, name: str, register: str) -> float:
        """What it takes to save a register: once, if none is in it yet, or around each call that destroys it."""
        if register not in SAVED:
            return 2 * MEMORY * self.crossing.get(name, 0.0)
        unit = max(self.frequency.values()) / MOST_FREQUENT
        return 0.0 if register in self.register.values() else SAVING * unit

    def evict(self, name: str) -> None:
        """Take the register of a web, for a reload needs it: it goes where no instruction computes, or to memory."""
        taken = {self.register.get(other) for other in self.conflicts[name]}
        free = (register for register, bank in REGISTERS.items() if bank in BESIDE and register not in taken)
        self.register[name] = next(free, None)
        self.webs.bank[name] = _bank_of(self.register[name])


def is_call(instruction: MachineInstruction) -> bool:
    """Whether it is a call of this routine's, not what a library routine calls itself."""
    return instruction.op is Op.CALL and bool(instruction.code_bytes)


def _bank_of(register: str | None) -> RegisterBank:
    return REGISTERS[register] if register else RegisterBank.MEMORY
