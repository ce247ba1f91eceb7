"""Calls: of other kernels, of the run-time library, and of routines that fill or move memory."""

from __future__ import annotations

from bfsim.kernel import operations
from bfsim.kernel.estimate.loops.memory_calls import MemoryCall
from bfsim.kernel.estimate.selection.emitter import Emitter
from bfsim.kernel.estimate.selection.machine_code import RegisterBank
from bfsim.kernel.ir.text import Instruction
from bfsim.kernel.operations import Op
from bfsim.kernel.profile import LibraryRoutine

ANY, DATA, POINTER = RegisterBank.ANY, RegisterBank.DATA, RegisterBank.POINTER


class Calls:
    """Calls, and their arguments."""

    def __init__(self, emitter: Emitter) -> None:
        self.emitter, self.append = emitter, emitter.append
        self.context = emitter.context

    def call(self, each: Instruction) -> None:
        """A call of another kernel."""
        arguments = self.context.arguments(each)
        self.hand_over(each, arguments)
        self.append(self._op(each), each, each.result, DATA)

    def _op(self, each: Instruction) -> Op:
        tail = self.context.tail_calls.get(self.emitter.label)
        return Op.TAIL_CALL if tail is not None and tail.call is each else Op.CALL

    def hand_over(self, each: Instruction, arguments: list[str]) -> None:
        """Put arguments where the called function has them."""
        for number, value in enumerate(arguments):
            if number >= operations.REGISTER_ARGUMENTS:
                self.append(Op.STORE32, each, None, DATA, (value, ANY))
            elif self.context.is_there(value, number, each):
                continue  # computed right where it is passed, or passed on
            else:
                self.append(Op.IMM if not value.startswith("%") else Op.MOVE, each, None, DATA, (value, ANY))

    def memory(self, call: MemoryCall) -> None:
        """Call memset or memmove instead of iterating; the loop's counters give an unknown length (`memory_lengths`)."""
        each, root = call.store, self.context.flow.root
        self.emitter.label = self.context.flow.entering(call.place)
        if call.is_inline:
            self.append(Op.MOVE, each, None, POINTER, (root(each.operands[1]), ANY))
            self.append(Op.ALU, each, None, POINTER)  # a separate pointer that walks, and a step
            for _ in range(call.total or 0):
                self.append(Op.STORE8, each, None, DATA, (each.operands[0], ANY))
            return
        what = each.operands[0] if call.load is None else root(call.load.operands[0])
        for argument in (root(each.operands[1]), what, ""):
            used = ((argument, ANY),) if argument.startswith("%") else ()
            self.append(Op.MOVE if used else Op.IMM, each, None, DATA, *used)
        self.append(self._op(each), each, None, DATA)
        cclk = call.routine.cclk if call.total is None else call.routine.of(call.total)
        if call.nest is not None:
            cclk = call.routine.cclk + call.routine.words_cclk
        self.append(Op.LIBRARY, each, None, DATA, cclk=cclk, nbytes=0)
        if call.nest is not None:  # and what one iteration of the loop around adds
            self.emitter.label = self.context.flow.entering(call.loop)
            self.append(Op.LIBRARY, each, None, DATA, cclk=call.routine.blocks_of(call.total or 0), nbytes=0)

    def library(self, each: Instruction, routine: LibraryRoutine, name: str) -> None:
        """The cost of a routine of the run-time library."""
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
        self.hand_over(each, values[: operations.REGISTER_ARGUMENTS])
        self.append(Op.CALL, each, each.result, DATA)
        self.library(each, routine, name)
        if each.opcode == "fcmp":
            self.append(Op.COMPARE, each, None, DATA)  # of the integer that the library returns, with zero
