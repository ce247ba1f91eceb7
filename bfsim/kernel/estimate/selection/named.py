"""Operations that LLVM names and the Blackfin lacks, and the intrinsics of the kernel language."""

from __future__ import annotations

from itertools import pairwise

from bfsim.kernel import operations
from bfsim.kernel.estimate.selection.calls import Calls
from bfsim.kernel.estimate.selection.emitter import Emitter
from bfsim.kernel.estimate.selection.machine_code import RegisterBank
from bfsim.kernel.ir.text import Instruction, is_number
from bfsim.kernel.ir.widths import WORD
from bfsim.kernel.operations import Op

DATA = RegisterBank.DATA


class Named:
    """Operations that are calls in LLVM IR."""

    def __init__(self, emitter: Emitter, calls: Calls) -> None:
        self.emitter, self.append = emitter, emitter.append
        self.context, self.calls = emitter.context, calls

    def operation(self, each: Instruction) -> None:
        """An operation that LLVM calls by name, or an intrinsic of the kernel language."""
        values = tuple((value, DATA) for value in each.operands if not value.startswith(("true", "false")))
        if (intrinsic := each.intrinsic) is not None:
            self._instructions(each, intrinsic.ops)
        elif "@llvm.sqrt" in each.text or "@llvm.fpto" in each.text:
            self.calls.float_operation(each)
        elif "@llvm.fabs" in each.text:
            self.sign(each)
        elif "@llvm.cttz" in each.text:
            self._shift_by_zeros(each)
        elif "@llvm.bswap.i16" in each.text:
            self._swap_bytes(each)
        elif "@llvm.bswap.i32" in each.text:
            self._reverse_bytes(each)
        elif "@llvm.bitreverse" in each.text:
            self._swap_bits(each)
        elif "@llvm.umin" in each.text or "@llvm.umax" in each.text:
            self._unsigned_extreme(each, values)
        elif "@llvm.fsh" in each.text:
            self.append(Op.SHIFT, each, f"{each.result}.half", DATA, values[0])
            self.append(Op.SHIFT, each, f"{each.result}.half2", DATA, values[0])
            self.append(
                Op.ALU, each, each.result, DATA, (f"{each.result}.half", DATA), (f"{each.result}.half2", DATA)
            )
        else:
            self.append(Op.DSP_ALU, each, each.result, DATA, *values)

    def sign(self, each: Instruction) -> None:
        """Changing the sign of a float flips a bit."""
        self.append(Op.ALU, each, each.result, DATA, (each.operands[0], DATA))

    def _unsigned_extreme(self, each: Instruction, values: tuple[tuple[str, RegisterBank], ...]) -> None:
        """A comparison, of extended values if they are narrow, and a conditional move, which overwrites either operand."""
        (left, _), (right, _) = values
        if is_number(right) and int(right) not in operations.COMPARE_UNSIGNED_IMMEDIATE:
            right = self.emitter.load_bound(each, right)
        compared = left
        if each.bits < WORD:
            compared = f"{each.result}.extended"
            self.append(Op.EXTEND, each, compared, DATA, (left, DATA))
        self.append(Op.COMPARE, each, None, DATA, (compared, DATA), (right, DATA))
        self.append(Op.COND_MOVE, each, each.result, DATA, *values, overwrites=(left, values[1][0]))

    def _instructions(self, each: Instruction, ops: tuple[Op, ...]) -> None:
        """The instructions of an intrinsic, all of which are told to need its operands."""
        values = tuple((value if value.startswith("%") else f"#{value}", DATA) for value in each.operands)
        for op in ops[:-1]:
            self.append(op, each, f"{each.result}.step", DATA, *values)
        self.append(ops[-1], each, each.result, DATA, *values)

    def _shift_by_zeros(self, each: Instruction) -> None:
        """LLVM divides by a known power of two with a count of zeros; the Blackfin calls its library."""
        routine = self.context.profile.library.divide_unsigned
        self.calls.hand_over(each, list(each.operands[:1]) * 2)
        self.append(Op.CALL, each, each.result, DATA)
        self.calls.library(each, routine, "division")

    def _swap_bytes(self, each: Instruction) -> None:
        """Both bytes of a half-word are shifted, the upper one of a word, as in the source that LLVM has read as a swap."""
        value, up, down = (each.operands[0], DATA), f"{each.result}.up", f"{each.result}.down"
        self.append(Op.SHIFT, each, up, DATA, value)
        self.append(Op.EXTEND, each, down, DATA, value)
        self.append(Op.SHIFT, each, down, DATA, (down, DATA))
        self.append(Op.ALU, each, each.result, DATA, (up, DATA), (down, DATA))

    def _reverse_bytes(self, each: Instruction) -> None:
        """Each byte of a word is shifted to its place, both inner ones are masked, and all are joined, as most people write it."""
        value = (each.operands[0], DATA)
        parts = [(f"{each.result}.part{number}", DATA) for number in range(4)]
        for number, (name, _) in enumerate(parts):
            self.append(Op.SHIFT, each, name, DATA, value)
            if number in (1, 2):
                self.append(Op.ALU, each, name, DATA, (name, DATA), (f"#{name}", DATA))
        for one, other in pairwise(parts[:-1]):
            self.append(Op.ALU, each, other[0], DATA, one, other)
        self.append(Op.ALU, each, each.result, DATA, parts[-2], parts[-1])

    def _swap_bits(self, each: Instruction) -> None:
        """Halves are swapped over and over, as in the source that LLVM has read as a reversal."""
        for stage in range(4):
            self.append(Op.SHIFT, each, f"{each.result}.up", DATA, (each.operands[0], DATA))
            self.append(Op.SHIFT, each, f"{each.result}.down", DATA, (each.operands[0], DATA))
            for half in ("up", "down"):
                mask = (f"#{stage} {half}", DATA)
                self.append(
                    Op.ALU, each, f"{each.result}.{half}", DATA, (f"{each.result}.{half}", DATA), mask
                )
            self.append(
                Op.ALU, each, each.result, DATA, (f"{each.result}.up", DATA), (f"{each.result}.down", DATA)
            )
        self.append(Op.ALU, each, each.result, DATA, (each.result or "", DATA))
