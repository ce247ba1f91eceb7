"""Fields of a record at a computed index, `sums[at + 2]`: when GCC computes the address of a field separately, without an offset in the access.

An offset goes into an access only if that is the only use of the address [combine.cc]. So a field that is loaded and
stored has its own address: the index in bytes plus the field's offset, plus the array. And if `at` was computed in a
separate statement as a product with a number, the address of the array's element is a product with another number,
unlike `(at + 1) * 4`: the first field has an address computed from `at`, which the others share
[gimple-ssa-strength-reduction.cc, of what match.pd makes of `at * 6 * 4`].
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field

from bfsim.kernel.estimate.induction_variables.induction_variables import InductionVariables
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, is_number

ACCESSES = ("load", "store")


@dataclass(slots=True)
class FieldAddresses:
    """The field addresses of one routine, by the names of LLVM's pointers to fields."""

    flow: ControlFlow
    variables: InductionVariables
    own: set[str] = field(init=False, default_factory=set)
    """Fields with their own address."""
    copies: set[str] = field(init=False, default_factory=set)
    """Those of them after which another one is computed from the same index: then a copy of the index is added to."""
    first: set[str] = field(init=False, default_factory=set)
    """The first fields of records whose index is such a product."""

    def __post_init__(self) -> None:
        """Find them."""
        of_record: defaultdict[str, list[Instruction]] = defaultdict(list)
        for label in self.flow.order:
            for each in self.flow.blocks[label].instructions:
                if self._is_field(each):
                    of_record[each.operands[0]].append(each)
        for record, fields in of_record.items():
            own = [each.result or "" for each in fields if self._is_changed(each)]
            self.own |= {*own}
            self.copies |= {*own[:-1]}
            if not own and self._is_of_product(record, fields[0]):
                self.first.add(fields[0].result or "")

    def _is_field(self, each: Instruction) -> bool:
        """Whether an instruction adds an offset to the address of an element that no loop steps along."""
        record = self.flow.instruction(each.operands[0]) if each.opcode == "getelementptr" else None
        return (
            record is not None
            and record.opcode == "getelementptr"
            and record.operands[-1].startswith("%")
            and is_number(each.operands[-1])
            and not any(id(user) in self.variables.of for user in self._accesses(each))
        )

    def _accesses(self, each: Instruction) -> list[Instruction]:
        users = self.flow.users.get(each.result or "", [])
        return [user for user in users if user.opcode in ACCESSES and user.operands[-1] == each.result]

    def _is_changed(self, each: Instruction) -> bool:
        """Whether a field is both loaded and stored."""
        return {user.opcode for user in self._accesses(each)} == {*ACCESSES}

    def _is_of_product(self, record: str, each: Instruction) -> bool:
        """Whether the index of a record was multiplied by a number in a line before the access."""
        element = self.flow.instruction(record)
        product = self.flow.instruction(element.operands[-1]) if element is not None else None
        if product is not None and product.opcode == "zext":  # of a product that fits into a byte
            product = self.flow.instruction(product.operands[0])
        return (
            product is not None
            and product.opcode in ("mul", "shl")
            and is_number(product.operands[1])
            and product.line != each.line
        )
