"""Starts of an inner loop's pointers: what the loop around steps for them [tree-ssa-loop-ivopts.cc of GCC 12].

To find a[y * w + x], the loop over the rows steps the end of a row, by which the columns are counted, and the row's distance
from the array: one sum of these for all arrays of bytes. Each array of half-words or words has its own pointer.
"""

from __future__ import annotations

from bfsim.kernel.estimate.induction_variables.induction_variable import InductionVariable
from bfsim.kernel.estimate.selection.context import Context
from bfsim.kernel.estimate.selection.emitter import Emitter
from bfsim.kernel.estimate.selection.iteration_counts import IterationCounts
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.ir.control_flow import Loop
from bfsim.kernel.ir.text import is_number
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule

ANY, DATA, POINTER = RegisterBank.ANY, RegisterBank.DATA, RegisterBank.POINTER
ROW = "row"


class RowPointers:
    """Starts of the pointers of one routine."""

    def __init__(self, emitter: Emitter) -> None:
        self.emitter = emitter
        self.context: Context = emitter.context
        self.flow, self.evolution = self.context.flow, self.context.evolution
        self.counts = IterationCounts(self.context)
        self.made: set[str] = set()

    def start(self, variable: InductionVariable) -> bool:
        """Compute the start of a pointer, if the loop around steps it; return whether it does."""
        loop, around = variable.loop, self.flow.around(variable.loop)
        if around is None or not self.context.profile.applies(Rule.ROW_POINTERS):
            return False
        if not self._moves(variable) or (variable.increment.symbolic and self._is_beside(variable, around)):
            return False
        if self.counts.pointer(loop) is variable:
            self._start_counted(variable, around)
        elif self._is_bytewise(variable):
            self._add(
                variable,
                self.flow.entering(loop),
                Op.ALU,
                variable.name,
                variable.root,
                self._offset(variable, around),
            )
        else:
            bank = DATA if variable.increment.symbolic else POINTER
            own = self._stepped(variable, around, f"{variable.name}.{ROW}", bank)
            self._add(variable, self.flow.entering(loop), Op.MOVE, variable.name, own)
        return True

    def _start_counted(self, variable: InductionVariable, around: Loop) -> None:
        """Compute the start of the pointer that is compared with its end."""
        before = self.flow.entering(variable.loop)
        end = self._stepped(variable, around, f"{variable.name}.end", DATA)
        if self.counts.is_known(variable.loop):
            self._add(variable, before, Op.MOVE, variable.name, end)
            self._add(variable, before, Op.ALU, variable.name, variable.name)
        elif self._is_bytewise(variable) and is_number(self.evolution.counter_start(variable.loop) or ""):
            self._add(variable, before, Op.ALU, variable.name, variable.root, self._offset(variable, around))
            self._add(variable, before, Op.MOVE, None, end)
        else:
            self._add(variable, before, Op.ALU, None, end)
            self._add(variable, before, Op.MOVE, variable.name, end)

    def _moves(self, variable: InductionVariable) -> bool:
        """Whether the loop around steps the start of a pointer by the same amount each time."""
        around = self.flow.around(variable.loop)
        assert around is not None
        gains = [self.evolution.increment(name, around) for name in self._row(variable)]
        return all(gain is not None for gain in gains) and any(
            gain.moves for gain in gains if gain is not None
        )

    def _row(self, variable: InductionVariable) -> dict[str, int]:
        """The terms added to the array's address at the start of a pointer, with factors."""
        terms = self.evolution.affine(variable.accesses[0].instruction.operands[-1]).terms
        return {
            name: times
            for name, times in terms
            if name != variable.root and not self._is_stepped(name, variable.loop)
        }

    def _is_stepped(self, name: str, loop: Loop) -> bool:
        """Whether a value is a variable of `loop`, or a multiple of one."""
        gain = self.evolution.increment(name, loop)
        return gain is not None and (gain.moves or gain.symbolic)

    def _is_beside(self, variable: InductionVariable, around: Loop) -> bool:
        """Whether a pointer of the loop around walks along the same array: a column starts there."""
        return any(
            each.loop is around and each.root == variable.root
            for each in self.context.induction_variables.all
        )

    def _is_bytewise(self, variable: InductionVariable) -> bool:
        return abs(variable.increment.constant) == 1 or variable.accesses[0].instruction.bits == 8

    def _offset(self, variable: InductionVariable, around: Loop) -> str:
        """The name of the distance from an array's address to the row, which arrays of bytes share."""
        row = self._row(variable)
        there = self._there(row, around)
        if there:
            return there
        key = ".".join(f"{name}{times}" for name, times in sorted(row.items()))
        return self._stepped(variable, around, f"{around.header}.{ROW}{key}", POINTER)

    def _there(self, row: dict[str, int], around: Loop) -> str:
        """The name of an equal value that the loop around has anyway."""
        for label in self.flow.inside(around):
            for each in self.flow.blocks[label].instructions:
                name = each.result or ""
                if (
                    each.opcode in ("phi", "mul", "add", "shl")
                    and each.bits == 32
                    and self.context.demanded.emits(each)
                ):
                    affine = self.evolution.affine(name)
                    if dict(affine.terms) == row and self.flow.innermost(label) is around:
                        return self.context.name(name)
        return ""

    def _stepped(self, variable: InductionVariable, around: Loop, name: str, bank: RegisterBank) -> str:
        """Make a variable of the loop around, and return its name."""
        name = f"%{name.removeprefix('%')}"
        if name in self.made:
            return name
        self.made.add(name)
        gains = [self.evolution.increment(each, around) for each in self._row(variable)]
        is_symbolic = any(gain is not None and gain.symbolic for gain in gains)
        self._add(variable, self.flow.entering(around), Op.MOVE, name, variable.root, bank=bank)
        if is_symbolic and bank is POINTER:
            self._add(variable, around.latch, Op.MOVE, None, f"{around.header}.stride")
        self._add(variable, around.latch, Op.ALU, name, name, bank=bank)
        return name

    def _add(
        self,
        variable: InductionVariable,
        label: str,
        op: Op,
        result: str | None,
        *operands: str,
        bank: RegisterBank = POINTER,
    ) -> None:
        uses = tuple((self.context.name(each), ANY) for each in operands)
        self.emitter.code.add(label, MachineInstruction(op, variable.line, result, bank, uses))
