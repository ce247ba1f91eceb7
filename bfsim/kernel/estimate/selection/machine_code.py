"""Blackfin instructions on values that have no register yet, and how a routine's control flow will be coded."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from bfsim.kernel.ir.text import Instruction, SourceLine
from bfsim.kernel.operations import COSTS, Op


class RegisterBank(Enum):
    """Where a value must be: data register, pointer register, or either; some pointers end up in index registers."""

    DATA = "R"
    POINTER = "P"
    INDEX = "I"
    ANY = "R/P"


@dataclass(slots=True)
class MachineInstruction:
    """One operation. `uses` are names of values, or constants written #5; `overwrites`: the operand it destroys."""

    op: Op
    line: SourceLine
    result: str | None
    bank: RegisterBank
    uses: tuple[tuple[str, RegisterBank], ...] = ()
    overwrites: tuple[str, ...] = ()
    cclk: int | None = None
    """Cycles, if they differ from those of the operation."""
    nbytes: int | None = None
    """Bytes of code, if they differ from those of the operation."""
    access: Instruction | None = None
    """The access of the IR that it makes."""
    routine: str = ""
    """The routine of the run-time library that it belongs to."""

    @property
    def code_bytes(self) -> int:
        """Bytes of code."""
        return COSTS[self.op].nbytes if self.nbytes is None else self.nbytes


@dataclass(slots=True)
class MachineCode:
    """The operations of each block of a routine, without its branches."""

    of: dict[str, list[MachineInstruction]] = field(default_factory=dict)

    def add(self, label: str, instruction: MachineInstruction) -> None:
        """Append to a block."""
        self.of.setdefault(label, []).append(instruction)
