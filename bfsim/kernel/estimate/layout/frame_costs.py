"""The costs of entering and leaving a routine: registers are saved and restored, and a frame is linked if it calls another one."""

from __future__ import annotations

from bfsim.kernel.costs.charges import Charge, charge
from bfsim.kernel.estimate.registers.registers import Allocation
from bfsim.kernel.ir.text import SourceLine
from bfsim.kernel.operations import Op
from bfsim.kernel.profile import CompilerProfile


class FrameCosts:
    """The frame costs of one routine."""

    def __init__(self, allocation: Allocation, profile: CompilerProfile) -> None:
        self.allocation, self.profile = allocation, profile
        self.saved = allocation.saved_data + allocation.saved_pointers

    def entering(self, line: SourceLine) -> list[Charge]:
        """Return what is done before the first instruction."""
        ops: tuple[Op, ...] = ()
        if self.allocation.calls:
            ops = (Op.LINK,) if self.allocation.saves_frame_pointer else (Op.PUSH, Op.ALU)
        elif self.allocation.saves_frame_pointer:
            ops = (Op.PUSH,)
        several = Charge(Op.PUSH_MULTIPLE, line, self.profile.push_multiple_cclk or self.saved)
        return [*([several] if self.saved else ()), *(charge(op, line) for op in ops)]

    def leaving(self, line: SourceLine) -> list[Charge]:
        """Return what is done at a return, itself included."""
        ops: tuple[Op, ...] = ()
        if self.allocation.calls:
            ops = (Op.ALU, Op.POP, Op.POP) if self.allocation.saves_frame_pointer else (Op.ALU, Op.POP)
        elif self.allocation.saves_frame_pointer:
            ops = (Op.POP,)
        several = Charge(Op.POP_MULTIPLE, line, self.profile.pop_multiple_cclk or self.saved)
        charges = [*(charge(op, line) for op in ops), *([several] if self.saved else ())]
        return [*charges, charge(Op.RETURN, line)]
