"""Arithmetic: sums, shifts, logic, products, and extensions."""

from __future__ import annotations

from dataclasses import replace

from bfsim.kernel import operations
from bfsim.kernel.estimate.arithmetic.multiples import STEP, Step
from bfsim.kernel.estimate.selection.divisions import Divisions
from bfsim.kernel.estimate.selection.emitter import Emitter
from bfsim.kernel.estimate.selection.machine_code import MachineInstruction, RegisterBank
from bfsim.kernel.ir.text import Instruction, is_number
from bfsim.kernel.operations import Op
from bfsim.kernel.rules import Rule

ANY, DATA, POINTER = RegisterBank.ANY, RegisterBank.DATA, RegisterBank.POINTER
EXTENDING_MASKS = {"255": 8, "65535": 16}


class Arithmetic:
    """Arithmetic on words."""

    def __init__(self, emitter: Emitter, divisions: Divisions) -> None:
        self.emitter, self.append = emitter, emitter.append
        self.context, self.flow = emitter.context, emitter.context.flow
        self.divisions = divisions
        self.factors = set[tuple[str, str]]()
        """Bytes that have been extended for a product, with the block: other products there take the same extension."""
        self.multiples = dict[tuple[str, str, tuple[Step, ...]], str]()
        """What the first steps of a product leave, by block and factor: other products there begin with it [cse.cc]."""

    def add(self, each: Instruction) -> None:
        if self.context.folding.in_shifted_sum(each):
            return
        if (product := self.context.folding.products.accumulates(each)) is not None:
            sum_before = next(operand for operand in each.operands if operand != product.result)
            factors = ((operand, DATA) for operand in product.operands[:2])
            self.append(Op.MAC, each, each.result, DATA, (sum_before, DATA), *factors)
            return
        if (plan := self.context.folding.shift_add(each)) is not None:
            shifted, other = plan
            self.append(Op.ADD_SHIFT, each, each.result, POINTER, (other, POINTER), (shifted, POINTER))
            return
        if (division := self.context.folding.remainder(each)) is not None:
            rest = replace(each, opcode=division.opcode.replace("div", "rem"), operands=division.operands)
            self.divisions.divide(rest)
            return
        left, right = each.operands[:2]
        if (total := self.context.folding.added_flag(each)) is not None:
            self.append(Op.ALU, each, each.result, ANY, (total, ANY))
            return
        if self.context.narrow.narrowed(each):
            self.append(Op.MOVE, each, None, DATA)
            self.append(Op.ALU, each, None, DATA, (left, DATA))
        if is_number(right) and int(right) in operations.ADD_IMMEDIATE and each.opcode == "add":
            self.append(Op.ALU, each, each.result, ANY, (left, ANY), overwrites=(left,))
        elif each.opcode == "sub" and left == "0":
            self.append(Op.ALU, each, each.result, DATA, (right, DATA))
        else:
            self.append(Op.ALU, each, each.result, ANY, (left, ANY), (right, ANY))

    def shift(self, each: Instruction) -> None:
        if self.context.is_alias(each):
            return
        if self.context.folding.in_shift_add(each) or self._is_half_extension(each):
            return
        if (word := self.context.folding.counted_bits(each)) is not None:
            self.append(Op.ALU, each, each.result, DATA, (word, DATA))
            self.append(Op.EXTEND, each, each.result, DATA, (each.result or "", DATA))
            return
        value, amount = each.operands[:2]
        if (pair := self.context.folding.shifted_sum(each)) is not None:
            self.append(Op.ADD_SHIFT, each, each.result, ANY, (pair[0], ANY), (pair[1], ANY), overwrites=pair)
        elif each.opcode == "ashr" and (source := self.context.folding.extension_of(each)):
            self.append(Op.EXTEND, each, each.result, DATA, (source, DATA))
        elif amount.isdigit():
            near = int(amount) in operations.ADDRESS_SHIFTS and each.opcode != "ashr"
            kept = len(self.flow.users.get(value, [])) > 1  # three operands take the long form
            where = ANY if near else DATA
            nbytes = operations.LONG_FORM_BYTES if kept else None
            self.append(Op.SHIFT, each, each.result, where, (value, where), nbytes=nbytes)
        else:
            self.append(Op.SHIFT, each, each.result, DATA, (value, DATA), (amount, DATA), overwrites=(value,))

    def _is_half_extension(self, each: Instruction) -> bool:
        users = self.flow.users.get(each.result or "", [])
        return each.opcode == "shl" and bool(users) and all(
            self.context.folding.extension_of(user) == each.operands[0] for user in users
        )  # fmt: skip

    def logic(self, each: Instruction) -> None:
        left, right = each.operands[:2]
        folding = self.context.folding
        if folding.in_bit_test(each) or folding.is_shift_mask(each) or folding.in_sunk_mask(each):
            return
        if each.opcode == "and" and right in EXTENDING_MASKS:
            self.append(Op.EXTEND, each, each.result, DATA, (left, DATA))
        elif self._is_single_bit(each.opcode, right):
            self.append(Op.ALU, each, each.result, DATA, (left, DATA), overwrites=(left,))
        else:
            self.append(Op.ALU, each, each.result, DATA, (left, DATA), (right, DATA))

    def _is_single_bit(self, opcode: str, right: str) -> bool:
        """Whether BITSET, BITCLR, BITTGL or NOT does it."""
        if not is_number(right) or not self.context.profile.applies(Rule.SINGLE_BITS):
            return False
        mask = int(right)
        bits = ~mask if opcode == "and" else mask
        return (opcode == "xor" and mask == -1) or (bits & 0xFFFFFFFF).bit_count() == 1

    def multiply(self, each: Instruction) -> None:
        left, right = each.operands[:2]
        if self._steps_along(each) or self.context.folding.products.accumulated(each) is not None:
            return
        if (steps := self.context.folding.products.steps_of(each)) is not None:
            self._multiple(each, left, steps)
        elif self.context.folding.products.is_short(each) or self.context.narrow.in_narrow_tree(each):
            for factor in dict.fromkeys((left, right)):
                is_extended = (self.emitter.label, factor) in self.factors
                if self.context.narrow.extended_for_product(factor) and not is_extended:
                    self.factors.add((self.emitter.label, factor))
                    self.append(Op.EXTEND, each, None, DATA, (factor, DATA))
            self.append(Op.MUL16, each, each.result, DATA, (left, DATA), (right, DATA))
        else:
            self.append(
                Op.MUL32, each, each.result, DATA, (left, DATA), (right, DATA), overwrites=(left, right)
            )

    def _multiple(self, each: Instruction, factor: str, steps: tuple[Step, ...]) -> None:
        """Shifts and sums; a pointer register is shifted by 1 or 2 only, and what is shifted further is added to where it is."""
        value = before = factor
        bank = ANY
        knows_banks = self.context.profile.applies(Rule.PRODUCT_STEPS)
        is_whole = not self.context.folding.in_shifted_addition(each)
        for number, step in enumerate(steps if is_whole else steps[:-1]):
            result = each.result or "" if number == len(steps) - 1 else f"{each.result}{STEP}{number}"
            made = self.emitter.label, factor, steps[: number + 1]
            if knows_banks and result != each.result and made in self.multiples:
                before, value = value, self.multiples[made]
                continue
            self.multiples[made] = result
            is_shift = step.op is Op.SHIFT
            follows_shift = number > 0 and steps[number - 1].op is Op.SHIFT
            if knows_banks and is_shift:
                bank = ANY if step.shift in operations.ADDRESS_SHIFTS else DATA
            elif not (knows_banks and follows_shift):
                bank = POINTER if step.op is Op.ADD_SHIFT and not follows_shift else ANY
            other = (before if follows_shift else value) if knows_banks and step.with_itself else factor
            others = () if knows_banks and is_shift else ((other, bank),)
            self.append(step.op, each, result, bank, (value, bank), *others)
            before, value = value, result

    def _steps_along(self, each: Instruction) -> bool:
        """Whether it is a product of a counter: an addition per iteration replaces it (strength reduction)."""
        loop, increment = self.flow.innermost(self.emitter.label), self.context.demanded.stepped(each)
        if loop is None or increment is None:
            return False
        stride = f"{each.result}.stride"
        self.emitter.code.add(
            self.flow.entering(loop), MachineInstruction(Op.IMM, each.line, each.result, ANY)
        )
        uses = (
            ((each.result or "", ANY), (stride, ANY)) if increment.symbolic else ((each.result or "", ANY),)
        )
        self.emitter.code.add(loop.latch, MachineInstruction(Op.ALU, each.line, each.result, ANY, uses))
        return True

    def extend(self, each: Instruction) -> None:
        if self.context.is_alias(each):
            return
        if " i1 " in each.text:
            self.append(Op.CC_MOVE, each, each.result, DATA)
        else:
            self.append(Op.EXTEND, each, each.result, DATA, (each.operands[0], DATA))
