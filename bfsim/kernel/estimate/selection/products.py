"""Products: which take 16 bits, which are shifts and sums, and what is part of them."""

from __future__ import annotations

from bfsim.kernel.estimate.arithmetic.multiples import STEP, Step, steps_of
from bfsim.kernel.estimate.arithmetic.narrow_factors import NARROW, is_narrow_product
from bfsim.kernel.estimate.selection.narrow_trees import is_cut_tree
from bfsim.kernel.ir.control_flow import ControlFlow
from bfsim.kernel.ir.text import Instruction, is_number
from bfsim.kernel.ir.widths import BYTE
from bfsim.kernel.operations import ADDRESS_SHIFTS, Op
from bfsim.kernel.profile import CompilerProfile
from bfsim.kernel.rules import Rule

HALF_WORD = 2 * BYTE


class Products:
    """Those of one routine."""

    def __init__(self, flow: ControlFlow, profile: CompilerProfile) -> None:
        self.flow, self.profile = flow, profile

    def is_short(self, each: Instruction) -> bool:
        """Whether a product is one of 16 bits."""
        if self.profile.applies(Rule.NARROW_FACTORS):
            return is_narrow_product(self.flow, each)
        is_made_narrow = each.bits == BYTE and self._is_extended(each)  # LLVM multiplies bytes that fit
        return is_made_narrow or all(map(self.is_short_factor, each.operands[:2]))

    def _is_extended(self, each: Instruction) -> bool:
        users = self._users(each.result or "")
        return bool(users) and all(user.opcode == "zext" for user in users)

    def does_extension(self, extension: Instruction) -> bool:
        """Whether an extension of a half-word is done by the products of 16 bits that use it, or that it is of."""
        if extension.bits != HALF_WORD or not self.profile.applies(Rule.NARROW_FACTORS):
            return False
        made = self.flow.instruction(extension.operands[0])
        is_of_product = made is not None and made.opcode == "mul" and self.is_short(made)
        return is_of_product or self.is_narrow_factor(extension)

    def is_narrow_factor(self, each: Instruction) -> bool:
        """Whether nothing but products of 16 bits use a value."""
        users = self._users(each.result or "") if self.profile.applies(Rule.NARROW_FACTORS) else []
        return bool(users) and all(user.opcode == "mul" and self.is_short(user) for user in users)

    def is_short_factor(self, operand: str) -> bool:
        """Whether a compiler sees that a factor has 16 bits: a constant, or a narrow value that was extended."""
        if is_number(operand):
            return -(1 << 15) <= int(operand) < 1 << 15
        each = self.flow.instruction(operand)
        return each is not None and each.opcode in ("sext", "zext", "load") and each.bits in NARROW

    def steps_of(self, product: Instruction) -> tuple[Step, ...] | None:
        """The shifts and sums that a product with a constant becomes; None if GCC multiplies."""
        if product.opcode != "mul" or not is_number(product.operands[1]):
            return None
        is_cut = self.profile.applies(Rule.NARROW_TREES) and is_cut_tree(self._users, product)
        return None if self.is_short(product) and not is_cut else steps_of(int(product.operands[1]))

    def shifted_last(self, product: Instruction) -> str | None:
        """What is shifted by 1 or 2 at the end of a product with a constant, if an addition can do that."""
        steps = (self.steps_of(product) if self.profile.applies(Rule.PRODUCT_STEPS) else None) or ()
        ends = len(steps) > 1 and steps[-1].op is Op.SHIFT and steps[-1].shift in ADDRESS_SHIFTS
        return f"{product.result}{STEP}{len(steps) - 2}" if ends else None

    def accumulated(self, product: Instruction) -> Instruction | None:
        """The addition of a 16-bit product to a sum that a loop carries, where the compiler has one operation for both."""
        users = self._users(product.result or "")
        if (
            not self.profile.accumulates
            or product.opcode != "mul"
            or len(users) != 1
            or users[0].opcode != "add"
        ):
            return None
        others = [self.flow.instruction(each) for each in users[0].operands if each != product.result]
        carried = any(
            each is not None and each.opcode == "phi" and users[0].result in each.operands for each in others
        )
        return users[0] if carried and self.is_short(product) else None

    def accumulates(self, addition: Instruction) -> Instruction | None:
        """The product that an addition takes in as a multiply-accumulate."""
        products = (self.flow.instruction(each) for each in addition.operands)
        return next(
            (each for each in products if each is not None and self.accumulated(each) is addition), None
        )

    def _users(self, value: str) -> list[Instruction]:
        return self.flow.users.get(value, [])
