"""Calls: of other kernels, of the run-time library, and of what LLVM has names for and the Blackfin has not."""

from __future__ import annotations

from itertools import pairwise

from bfsim.kernel import operations
from bfsim.kernel.estimate.arithmetic.multiples import multiple
from bfsim.kernel.estimate.arithmetic.powers import by_power, divided_by_power
from bfsim.kernel.estimate.loops.idioms import fills_of
from bfsim.kernel.estimate.selection.constants import load_constant
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.machine_code import MachineCode, MachineInstruction, RegisterBank
from bfsim.kernel.ir.control_flow import Loop
from bfsim.kernel.ir.text import Instruction, is_number
from bfsim.kernel.ir.widths import WORD
from bfsim.kernel.operations import Op
from bfsim.kernel.profile import LibraryRoutine

ANY, DATA = RegisterBank.ANY, RegisterBank.DATA
RECIPROCAL = 1 << 35  # divided by the divisor: a constant of 32 bits


class Calls:
    """Emits instructions into the block `label`; here those of calls and divisions."""

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

    def call(self, each: Instruction) -> None:
        if not each.is_call:
            self._intrinsic(each)
            return
        arguments = self.context.arguments(each)
        self._pass(each, arguments)
        self.append(self._op(each), each, each.result, DATA)

    def _op(self, each: Instruction) -> Op:
        tail = self.context.tail_calls.get(self.label)
        return Op.TAIL_CALL if tail is not None and tail.call is each else Op.CALL

    def _pass(self, each: Instruction, arguments: list[str]) -> None:
        for number, value in enumerate(arguments):
            if number >= operations.REGISTER_ARGUMENTS:
                self.append(Op.STORE32, each, None, DATA, (value, ANY))
            elif self.context.is_there(value, number, each):
                continue  # computed right where it is passed, or passed on
            else:
                self.append(Op.IMM if not value.startswith("%") else Op.MOVE, each, None, DATA, (value, ANY))

    def _intrinsic(self, each: Instruction) -> None:
        values = tuple((value, DATA) for value in each.operands if not value.startswith(("true", "false")))
        if (intrinsic := each.intrinsic) is not None:
            self._instructions(each, intrinsic.ops)
        elif "@llvm.sqrt" in each.text or "@llvm.fpto" in each.text:
            self.float_operation(each)
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

    def _unsigned_extreme(self, each: Instruction, values: tuple[tuple[str, RegisterBank], ...]) -> None:
        """A comparison, of what is extended if it is narrow, and a conditional move, which overwrites either operand."""
        (left, _), (right, _) = values
        if is_number(right) and int(right) not in operations.COMPARE_UNSIGNED_IMMEDIATE:
            self.code.add(self.label, load_constant(f"#{right}", each.line, f"{each.result}.bound"))
            right = f"{each.result}.bound"
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
        """LLVM divides by what it knows to be a power of two with a count of zeros; the Blackfin calls its library."""
        routine = self.context.profile.library.divide_unsigned
        self._pass(each, list(each.operands[:1]) * 2)
        self.append(Op.CALL, each, each.result, DATA)
        self._library(each, routine, "division")

    def _swap_bytes(self, each: Instruction) -> None:
        """Both bytes of a half-word are shifted, the upper one of a word, as the source does of which LLVM has read a swap."""
        value, up, down = (each.operands[0], DATA), f"{each.result}.up", f"{each.result}.down"
        self.append(Op.SHIFT, each, up, DATA, value)
        self.append(Op.EXTEND, each, down, DATA, value)
        self.append(Op.SHIFT, each, down, DATA, (down, DATA))
        self.append(Op.ALU, each, each.result, DATA, (up, DATA), (down, DATA))

    def _reverse_bytes(self, each: Instruction) -> None:
        """Each byte of a word is shifted to its place, both inner ones are masked, and all are joined, as most write it."""
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
        """Halves are swapped over and over, as the source does from which LLVM has read the whole reversal."""
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

    def fill(self, loop: Loop) -> None:
        """Call memset instead of iterating; of an unknown length, the loop's counters tell (`counted_fills`)."""
        fill = self.context.profile.library.fill
        assert fill is not None
        iterations = self.context.evolution.iterations(loop)
        for each in fills_of(self.context.flow, loop):
            self.label = self.context.flow.entering(loop)
            root = self.context.flow.root(each.operands[1])
            for argument in (root, each.operands[0], ""):
                used = ((argument, ANY),) if argument.startswith("%") else ()
                self.append(Op.MOVE if used else Op.IMM, each, None, DATA, *used)
            self.append(self._op(each), each, None, DATA)
            nbytes = each.bits // operations.BYTE_BITS
            cclk = fill.cclk if iterations is None else fill.of(iterations * nbytes)
            self.append(Op.LIBRARY, each, None, DATA, cclk=cclk, nbytes=0)

    def _library(self, each: Instruction, routine: LibraryRoutine, name: str) -> None:
        if routine.mix:
            for op, count in routine.mix:
                for _ in range(count):
                    self.append(op, each, None, DATA, nbytes=0, routine=name)
        else:
            self.append(Op.LIBRARY, each, None, DATA, cclk=routine.cclk, nbytes=0, routine=name)

    def float_operation(self, each: Instruction) -> None:
        """A call of the soft-float library."""
        library = self.context.profile.floats
        assert library is not None
        if "@llvm.sqrt" in each.text:
            routine, name = library.square_root, "float square root"
        else:
            routine, name = {
                "fadd": (library.add, "float addition"), "fsub": (library.subtract, "float subtraction"),
                "fmul": (library.multiply, "float multiplication"), "fdiv": (library.divide, "float division"),
                "fcmp": (library.compare, "float comparison"), "sitofp": (library.from_integer, "conversion to float"),
                "uitofp": (library.from_integer, "conversion to float"),
            }.get(each.opcode, (library.to_integer, "conversion from float"))  # fmt: skip
        values = [operand for operand in each.operands if operand.startswith("%") or operand[:1].isdigit()]
        self._pass(each, values[: operations.REGISTER_ARGUMENTS])
        self.append(Op.CALL, each, each.result, DATA)
        self._library(each, routine, name)
        if each.opcode == "fcmp":
            self.append(Op.COMPARE, each, None, DATA)  # of the integer that the library returns, with zero

    def sign(self, each: Instruction) -> None:
        """Changing the sign of a float flips a bit."""
        self.append(Op.ALU, each, each.result, DATA, (each.operands[0], DATA))

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
        self._pass(each, list(each.operands[:2]))
        self.append(Op.CALL, each, each.result, DATA)
        self._library(each, routine, "division" if each.opcode.endswith("div") else "remainder")

    def _divide_by_power(self, each: Instruction) -> None:
        """The likelier way, of a dividend that is not negative, has no code in between."""
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
