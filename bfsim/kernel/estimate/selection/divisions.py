"""Divisions: by a routine of the library, by a power of two, or by a constant."""

from __future__ import annotations

from bfsim.kernel.estimate.arithmetic.multiples import multiple
from bfsim.kernel.estimate.arithmetic.powers import by_power, divided_by_power
from bfsim.kernel.estimate.selection.calls import Calls
from bfsim.kernel.estimate.selection.emitter import Emitter
from bfsim.kernel.estimate.selection.machine_code import RegisterBank
from bfsim.kernel.ir.text import Instruction
from bfsim.kernel.operations import Op

DATA = RegisterBank.DATA
RECIPROCAL = 1 << 35  # divided by the divisor: a constant of 32 bits


class Divisions:
    """Quotients and remainders."""

    def __init__(self, emitter: Emitter, calls: Calls) -> None:
        self.emitter, self.append = emitter, emitter.append
        self.context, self.calls = emitter.context, calls

    def divide(self, each: Instruction) -> None:
        library = self.context.profile.library
        signed = self.context.divisions.divides_signed(each)
        routines = {
            ("div", True): library.divide_signed, ("div", False): library.divide_unsigned,
            ("rem", True): library.remainder_signed, ("rem", False): library.remainder_unsigned,
        }  # fmt: skip
        routine = routines[each.opcode[1:], signed]
        if divided_by_power(each):
            self._divide_by_power(each)
            return
        if not self.context.divisions.divides_by_call(each):
            self._divide_by_constant(each)
            return
        if self.context.demanded.rounds_down(each):
            self.append(Op.MUL32, each, f"{each.result}.back", DATA, (each.operands[1], DATA))
            self.append(
                Op.ALU, each, each.result, DATA, (each.operands[0], DATA), (f"{each.result}.back", DATA)
            )
            return
        self.calls.hand_over(each, list(each.operands[:2]))
        self.append(Op.CALL, each, each.result, DATA)
        self.calls.library(each, routine, "division" if each.opcode.endswith("div") else "remainder")

    def _divide_by_power(self, each: Instruction) -> None:
        """Divide by a power of two, at the cost of the likelier path, for a dividend that is not negative."""
        branch = Op.BRANCH_TAKEN_BP if each.opcode == "sdiv" else Op.BRANCH_NOT_TAKEN
        for op in by_power(each.opcode, int(each.operands[1]), branch) or ():
            self.append(op, each, each.result, DATA, (each.operands[0], DATA))

    def _divide_by_constant(self, each: Instruction) -> None:
        """The upper half of a product with the reciprocal [umulsi3_highpart of GCC: seven operations, and a move]."""
        value = each.operands[0]
        if each.opcode == "udiv" or not self.context.demanded.has_quotient(each):
            for _ in range(7):
                self.append(
                    Op.MAC, each, None, DATA, (value, DATA), (f"#{RECIPROCAL // int(each.operands[1])}", DATA)
                )
            self.append(Op.MOVE, each, each.result, DATA)
            self.append(Op.SHIFT, each, each.result, DATA, (each.result or "", DATA))
        if each.opcode == "urem":
            for op in multiple(int(each.operands[1])) or (Op.MUL32,):
                self.append(op, each, f"{each.result}.back", DATA, (each.result or "", DATA))
            self.append(Op.ALU, each, each.result, DATA, (value, DATA), (f"{each.result}.back", DATA))
