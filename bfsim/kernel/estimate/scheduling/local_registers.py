"""The data and pointer registers that the values of one block share, as far as the order of its instructions depends on them.

A register is reused as soon as its value is no longer needed, that of an operand first. So an instruction that writes
it waits for those that read it before.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.operations import DATA_REGISTERS, Op

DESTROYING = {Op.MUL32, Op.SHIFT}


@dataclass
class LocalRegisters:
    """The registers of one block. `alive`: the values that are live after it; `bank_of` returns the bank of a value.

    `uses` and `results` are the values of each instruction, those of loops by the name of their web; `read` and
    `written` are registers.
    """

    instructions: Sequence[MachineInstruction]
    bank_of: Callable[[str], RegisterBank | None]
    register_of: Callable[[str], str]
    alive: frozenset[str]
    uses: list[set[str]] = field(init=False)
    results: list[str | None] = field(init=False)
    read: list[set[str]] = field(default_factory=list)
    written: list[str | None] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Give each value that only this block uses the first register that is free as long as it is needed."""
        self.uses = [
            {self.register_of(name) for name in used(self.instructions, number)}
            for number in range(len(self.instructions))
        ]
        self.results = [self.register_of(each.result) if each.result else None for each in self.instructions]
        last = self._last_uses()
        own = {each for each in self.results if each is not None} - self.alive
        home: dict[str, str] = {}
        # for each register: the last instruction that needs its value
        busy = {name: last[name] for name in sorted(last) if name not in own}
        for number, result in enumerate(self.results):
            self.read.append({home.get(name, name) for name in self.uses[number]})
            if result in own:
                home[result] = self._free(number, result, last[result], busy, home)
            if result is not None:
                busy[home.get(result, result)] = last[result]
            self.written.append(home.get(result, result) if result is not None else None)

    @property
    def are_enough(self) -> bool:
        """Whether the data registers suffice; if not, values come from other registers when they are needed, and not before."""
        names = {name for names in (*self.read, self.alive) for name in names} | {*self.written} - {None}
        return sum(self.bank_of(name or "") is RegisterBank.DATA for name in names) <= DATA_REGISTERS

    def _last_uses(self) -> dict[str, int]:
        """Where each value is used last; after the block if it is live there."""
        last = {each: number for number, each in enumerate(self.results) if each is not None}
        last |= {name: number for number, uses in enumerate(self.uses) for name in uses}
        return last | dict.fromkeys(self.alive, len(self.instructions))

    def _free(self, number: int, result: str, until: int, busy: dict[str, int], home: dict[str, str]) -> str:
        """A register for the result of an instruction: that of an operand that it uses last, or the first free one."""
        operands = [home.get(name, name) for name, _ in self.instructions[number].uses]
        for register in (*operands, *busy):
            same_bank = self.bank_of(register) is self.bank_of(result)
            taken = register in self.results[number + 1 : until]
            if same_bank and busy.get(register, number + 1) <= number and not taken:
                return register
        return result


def copies_for(each: MachineInstruction, following: Sequence[MachineInstruction]) -> bool:
    """Whether an instruction copies an operand that the next one destroys: a product, or a shift."""
    return each.op is Op.MOVE and not each.uses and any(other.op in DESTROYING for other in following)


def used(instructions: Sequence[MachineInstruction], number: int) -> list[str]:
    """Values that an instruction reads."""
    each, following = instructions[number], instructions[number + 1 : number + 2]
    names = [name for name, _ in each.uses]
    if copies_for(each, following):
        names = [*following[0].overwrites]
    return [name for name in names if not name.startswith("#")]
