"""Pointers to half-words in data registers: those that a separate sum steps, from an argument that came in a data register.

Such a pointer could also be in an index register, I0 += 2 [addsi3 in bfin.md], so the first pass of find_costs_and_classes
finds the class IPREGS best. There a step costs a move in the second pass; then DPREGS is better, where only an access costs
one [ira-costs.cc of GCC 12]. The pointer gets the data register that it comes in, and each block that accesses something
moves it to a pointer register.
"""

from __future__ import annotations

from bfsim.kernel import operations
from bfsim.kernel.estimate.induction_variables.induction_variable import InductionVariable
from bfsim.kernel.estimate.registers.webs import Webs
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.ir.text import Instruction
from bfsim.kernel.operations import Op

ANY, DATA, POINTER = RegisterBank.ANY, RegisterBank.DATA, RegisterBank.POINTER
HALF_WORD = 2 * operations.BYTE_BITS
INDEX_STEPS = (2, 4)
"""What can be added to an index register [addsubsi in bfin.md]."""


class HalfWordPointers:
    """Puts such pointers of one routine into data registers."""

    def __init__(self, webs: Webs) -> None:
        self.webs, self.context, self.flow, self.code = webs, webs.context, webs.flow, webs.code

    def place(self) -> None:
        """Step them there, and move them where they are needed."""
        for variable in self.context.induction_variables.all:
            if self._is_stepped_apart(variable) and self._starts_in_register(variable):
                self.webs.bank[variable.name] = DATA
                for label, block in self.code.of.items():
                    self.code.of[label] = self._moved(variable.name, label, block)

    def _is_stepped_apart(self, variable: InductionVariable) -> bool:
        """Whether its step is a sum that an index register could do, and its only uses are accesses to half-words."""
        return (
            not variable.steps_free
            and not variable.increment.symbolic
            and variable.increment.constant in INDEX_STEPS
            and not any(self._shares_array(variable, other) for other in self.context.induction_variables.all)
            and all(
                self._takes_half_word(each) and variable.distance_of(each) == 0
                for _, each, _ in variable.accesses
            )
            and all(each.access is not None or each.result == variable.name for each in self._users(variable))
            and not any(each.op is Op.CALL for label in variable.loop.blocks for each in self.code.of[label])
        )

    def _takes_half_word(self, access: Instruction) -> bool:
        """Whether it accesses a half-word, of which more than a byte is wanted."""
        users = self.flow.users.get(access.result or "", [])
        is_byte = bool(users) and all(
            each.opcode == "trunc" and each.bits <= operations.BYTE_BITS for each in users
        )
        return access.bits == HALF_WORD and not is_byte

    def _shares_array(self, one: InductionVariable, other: InductionVariable) -> bool:
        return one is not other and one.loop is other.loop and one.root == other.root

    def _starts_in_register(self, variable: InductionVariable) -> bool:
        """Whether it starts with an argument that came in a register, or with one that a loop around has stepped."""
        evolution, loop = self.context.evolution, variable.loop
        terms = evolution.affine(variable.accesses[0][1].operands[-1]).terms
        arguments = self.context.parameters()[: operations.REGISTER_ARGUMENTS]
        others = [name for name, _ in terms if name != variable.root]
        is_plain = not any(evolution.code_motion.is_invariant(name, loop) for name in others)
        return (
            self.context.name(variable.root) in arguments
            and evolution.starts_fixed(loop)
            and not variable.start
            and (self.flow.around(loop) is not None or is_plain)
        )

    def _users(self, variable: InductionVariable) -> list[MachineInstruction]:
        return [
            each
            for block in self.code.of.values()
            for each in block
            if variable.name in (used for used, _ in each.uses)
        ]

    def _moved(self, name: str, label: str, block: list[MachineInstruction]) -> list[MachineInstruction]:
        """A block in which a pointer register holds the pointer of the accesses."""
        copy, found = f"{name}@{POINTER.value}.{label}", list[MachineInstruction]()
        for each in block:
            if each.result == name:
                each.bank = ANY
                each.uses = tuple((used, ANY if used == name else bank) for used, bank in each.uses)
            elif name in (used for used, _ in each.uses):
                if copy not in self.webs.bank:
                    self.webs.bank[copy] = POINTER
                    found.append(MachineInstruction(Op.MOVE, each.line, copy, POINTER, ((name, ANY),)))
                each.uses = tuple((copy if used == name else used, bank) for used, bank in each.uses)
            found.append(each)
        return found
