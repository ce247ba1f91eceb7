"""The output of the rules: the operations of each block, and the current block."""

from __future__ import annotations

from bfsim.kernel.estimate.selection.constants import BOUND, load_constant
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.machine_code import MachineCode, MachineInstruction, RegisterBank
from bfsim.kernel.ir.text import Instruction
from bfsim.kernel.operations import Op


class Emitter:
    """Appends operations to the block `label`."""

    def __init__(self, context: Context) -> None:
        self.context = context
        self.code = MachineCode({label: [] for label in context.flow.blocks})
        self.label = ""

    def append(self, op: Op, each: Instruction, result: str | None, bank: RegisterBank, *uses: tuple[str, RegisterBank],
             overwrites: tuple[str, ...] = (), cclk: int | None = None, nbytes: int | None = None, access: Instruction | None = None, routine: str = "") -> None:  # fmt: skip
        named = tuple(
            (value if value.startswith("#") else self.context.name(value), where) for value, where in uses
        )
        over = tuple(self.context.name(value) for value in overwrites)
        self.code.add(
            self.label,
            MachineInstruction(op, each.line, result, bank, named, over, cclk, nbytes, access, routine),
        )

    def load_bound(self, each: Instruction, number: str) -> str:
        """Load a number for a comparison that cannot take it as an immediate; return its name."""
        name = f"{each.result}{BOUND}"
        self.code.add(self.label, load_constant(f"#{number}", each.line, name))
        return name
