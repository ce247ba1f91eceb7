"""Instructions of the IR that are part of another operation of the Blackfin."""

from __future__ import annotations

from functools import cached_property

from bfsim.kernel.estimate.arithmetic.bits_set import counted_word
from bfsim.kernel.estimate.arithmetic.remainders import quotient_of_rest
from bfsim.kernel.estimate.selection.products import Products
from bfsim.kernel.ir.control_flow import BEFORE_TESTS, ControlFlow
from bfsim.kernel.ir.text import COUNTS, Instruction, is_number, predicate
from bfsim.kernel.operations import ADDRESS_SHIFTS
from bfsim.kernel.profile import CompilerProfile
from bfsim.kernel.rules import Rule

SHIFTS = ("shl", "lshr", "ashr")
SIGNS = {*((relation, "0") for relation in ("slt", "sle", "sgt", "sge")), ("sgt", "-1"), ("slt", "1")}
"""Tests of which sign a word has, as LLVM writes them."""
BYTE_MASK = 0xFF
HIGH_BYTE = 0xFF00  # a mask with these bits cuts a sum down to a half-word


class Folding:
    """What is folded into what, in one routine."""

    def __init__(self, flow: ControlFlow, profile: CompilerProfile, flags: frozenset[str | None]) -> None:
        """`flags`: what is computed from conditions without a branch (`if_conversion`)."""
        self.flow, self.profile, self.flags = flow, profile, flags
        self.products = Products(flow, profile)

    def shift_add(self, each: Instruction) -> tuple[str, str] | None:
        """The value that an addition shifts by 1 or 2 on the way, and the other one."""
        if each.opcode != "add":
            return None
        for operand, other in (each.operands[:2], each.operands[1::-1]):
            source = self.flow.instruction(operand)
            if source is None or len(self.users(operand)) != 1 or is_number(other):
                continue
            if (shifted := self.products.shifted_last(source)) is not None:
                return shifted, other
            if source.opcode == "shl":
                amount = source.operands[1]
                fits = amount.isdigit() and int(amount) in ADDRESS_SHIFTS
                if fits and self.shifted_sum(source) is None:
                    return source.operands[0], other
        return None

    def in_shifted_addition(self, product: Instruction) -> bool:
        """Whether the addition that uses a product does the shift at its end."""
        users = self.users(product.result or "")
        plan = self.shift_add(users[0]) if len(users) == 1 else None
        return plan is not None and plan[0] == self.products.shifted_last(product)

    def shifted_sum(self, shift: Instruction) -> tuple[str, str] | None:
        """The two values of (x + y) << 1 or 2, which is one operation."""
        source = self.flow.instruction(shift.operands[0])
        if (
            shift.opcode != "shl"
            or source is None
            or source.opcode != "add"
            or len(self.users(shift.operands[0])) != 1
        ):
            return None
        amount = shift.operands[1]
        constant = any(map(is_number, source.operands))
        if constant or not amount.isdigit() or int(amount) not in ADDRESS_SHIFTS:
            return None
        return source.operands[0], source.operands[1]

    def in_shifted_sum(self, each: Instruction) -> bool:
        """Whether an addition is done by the shift that uses it."""
        users = self.users(each.result or "")
        return each.opcode == "add" and len(users) == 1 and self.shifted_sum(users[0]) is not None

    def in_shift_add(self, shift: Instruction) -> bool:
        """Whether a shift is done by the addition that uses it."""
        users = self.users(shift.result or "")
        if len(users) != 1 or shift.opcode != "shl":
            return False
        plan = self.shift_add(users[0])
        return (
            plan is not None
            and plan[0] == shift.operands[0]
            and users[0].operands.count(shift.result or "") == 1
        )

    def extension_of(self, each: Instruction) -> str | None:
        """The value of which (x << k) >> k is the sign extension."""
        source = self.flow.instruction(each.operands[0])
        if each.opcode != "ashr" or source is None or source.opcode != "shl":
            return None
        alike = source.operands[1] == each.operands[1] and each.operands[1] in ("16", "24")
        return source.operands[0] if alike else None

    def is_shift_mask(self, each: Instruction) -> bool:
        """Whether an `and 31` is only the language's rule for shift counts: the shifter does it."""
        return COUNTS in (each.result or "") and all(
            user.opcode in SHIFTS and user.operands[1] == each.result
            for user in self.users(each.result or "")
        )

    def compared_difference(self, compare: Instruction) -> tuple[str, str] | None:
        """The two values that are compared in place of their difference and 0 ["X - Y CMP 0" in match.pd of GCC 12]."""
        made = self.flow.instruction(compare.operands[0])
        is_sign = compare.opcode == "icmp" and (predicate(compare), compare.operands[1]) in SIGNS
        if not is_sign or made is None or made.opcode != "sub" or self.users(made.result or "") != [compare]:
            return None
        return made.operands[0], made.operands[1]

    def in_comparison(self, each: Instruction) -> bool:
        """Whether a difference is not computed, for what is compared are the two values."""
        users = self.users(each.result or "")
        return each.opcode == "sub" and len(users) == 1 and self.compared_difference(users[0]) is not None

    def bit_tested(self, compare: Instruction) -> str | None:
        """The value of which a comparison tests a single bit."""
        masked = self.flow.instruction(compare.operands[0])
        if predicate(compare) not in ("eq", "ne") or compare.operands[1] != "0" or masked is None:
            return None
        mask, alone = masked.operands[-1], len(self.users(masked.result or "")) == 1
        single = masked.opcode == "and" and mask.isdigit() and int(mask).bit_count() == 1
        if not (single and alone) or self._is_overwritten(masked):
            return None
        return self._shifted_before(masked) or masked.operands[0]

    def _is_overwritten(self, masked: Instruction) -> bool:
        """Whether what is shifted behind the mask, or was moved before the branch, takes over the register of a value: it is compared behind that."""
        value, here = masked.operands[0], self._block_of(masked)
        own = {id(each) for each in here}
        behind = {id(each) for each in here[here.index(masked) :]}
        takes_over = any(
            each.operands[0] == value
            and ((each.result or "").endswith(BEFORE_TESTS) or id(each) in behind)
            and any(user.opcode == "phi" for user in self._users_of_bits(each))
            for each in here
            if each.opcode in SHIFTS
        )
        return takes_over and all(id(user) in own for user in self.users(value))

    def _users_of_bits(self, each: Instruction) -> list[Instruction]:
        """What uses a value, or some of its bits that are masked at once."""
        users = [*self.users(each.result or "")]
        masks = [user for user in users if user.opcode == "and" and is_number(user.operands[1])]
        at_once = (mask for mask in masks if not self.in_sunk_mask(mask))
        return users + [user for mask in at_once for user in self.users(mask.result or "")]

    def _shifted_before(self, masked: Instruction) -> str | None:
        """The value that was shifted before one of its bits is tested: LLVM makes a test of the value before of that."""
        value, here = masked.operands[0], self._block_of(masked)
        for each in here[: here.index(masked)]:
            if each.opcode == "shl" and each.operands[0] == value and is_number(each.operands[1]):
                bit = int(masked.operands[-1]).bit_length() - 1 + int(each.operands[1])
                return each.result if bit < each.bits else None
        return None

    def _block_of(self, each: Instruction) -> tuple[Instruction, ...]:
        return self.flow.blocks[self.flow.defined[each.result or ""][0]].instructions

    def in_bit_test(self, each: Instruction) -> bool:
        """Whether an `and` is done by a bit test."""
        users = self.users(each.result or "")
        return len(users) == 1 and users[0].opcode == "icmp" and self.bit_tested(users[0]) is not None and (
            users[0].operands[0] == each.result
        )  # fmt: skip

    def sunk_mask(self, phi: Instruction) -> bool:
        """Whether every arm of a phi ends in a mask of 8 bits, or of 16: as a conversion, it is done once behind them."""
        if phi.opcode != "phi" or len(phi.operands) < 2 or not self.profile.applies(Rule.SUNK_MASK):
            return False
        masks = [each for each in map(self._masked, phi.operands) if each is not None]
        if len(masks) < len(phi.operands) or self._is_written_before(masks):
            return False
        return len({self._is_byte_mask(each) for each in masks}) == 1

    def _is_written_before(self, masks: list[Instruction]) -> bool:
        """Whether it is one mask for all arms, which the source has before the test that they are of."""
        (mask, *others) = {id(each): each for each in masks}.values()
        here = self._block_of(mask)
        return not others and here[-1].opcode == "br" and mask.line.line < here[-1].line.line

    def _masked(self, value: str) -> Instruction | None:
        each = self.flow.instruction(value)
        if each is not None and each.opcode in ("xor", "or") and _fits_16(each.operands[1]):
            each = self.flow.instruction(each.operands[0])
        if each is None or each.opcode != "and" or not _fits_16(each.operands[1]):
            return None
        return each if int(each.operands[1]) >= HIGH_BYTE or self._is_byte_mask(each) else None

    def _is_byte_mask(self, each: Instruction) -> bool:
        """Whether a mask leaves a byte; LLVM takes out the lowest bit of it where a shift has made that 0."""
        shifted = self.flow.instruction(each.operands[0])
        is_even = shifted is not None and shifted.opcode == "shl" and shifted.operands[1] == "1"
        return each.operands[1] == str(BYTE_MASK) or (is_even and each.operands[1] == str(BYTE_MASK - 1))

    def in_sunk_mask(self, each: Instruction) -> bool:
        """Whether a mask is done behind the arms that end in it."""
        return id(each) in self._sunk

    @cached_property
    def _sunk(self) -> set[int]:
        phis = [
            each for block in self.flow.routine.blocks for each in block.instructions if self.sunk_mask(each)
        ]
        return {id(self._masked(value)) for each in phis for value in each.operands}

    def remainder(self, each: Instruction) -> Instruction | None:
        """The division whose remainder a difference is: where that is a call, it is another one."""
        return quotient_of_rest(self.flow, each) if self.profile.applies(Rule.REMAINDERS) else None

    def added_flag(self, each: Instruction) -> str | None:
        """The other operand of a sum with 0 or another constant, by the way: only the ways that do not bring 0 add.

        [partial redundancy elimination, tree-ssa-pre.cc of GCC 12]
        """
        if each.opcode != "add" or not self.profile.applies(Rule.ADDED_FLAGS):
            return None
        for operand, other in (each.operands[:2], each.operands[1::-1]):
            flag = self.flow.instruction(operand)
            if (
                flag is not None
                and flag.opcode == "phi"
                and operand not in self.flags
                and self.users(operand) == [each]
                and self.flow.defined[operand][0] == self.flow.defined[each.result or ""][0]
                and "0" in flag.operands
                and all(map(is_number, flag.operands))
            ):
                return other
        return None

    def counted_bits(self, each: Instruction) -> str | None:
        """The word whose bits an instruction ends up with, counted in parallel: an instruction does that."""
        return counted_word(self.flow, each) if self.profile.applies(Rule.PARALLEL_COUNTS) else None

    def users(self, value: str) -> list[Instruction]:
        """Return the instructions that use a value."""
        return self.flow.users.get(value, [])


def _fits_16(operand: str) -> bool:
    return operand.isdigit() and int(operand) <= 0xFFFF
