"""Values in code that is being made: LLVM IR written as sums and comparisons.

`a + b` emits the instruction that adds, and is its result. Python's numbers may stand on the right. `<` compares
signed, `below` unsigned. Shifts say what comes in: `shift_left`, `shift_right` (zeros), `shift_right_signed`. The
amount of a shift must be less than the width.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from llvmlite import ir


@dataclass(frozen=True, slots=True, eq=False)
class Value:
    """A value, and the builder that adds to the block where it is used."""

    builder: ir.IRBuilder
    ir: Any

    @property
    def bits(self) -> int:
        """Its width."""
        return int(self.ir.type.width)

    def constant(self, number: int, bits: int | None = None) -> Value:
        """Return a number, as wide as this value or of `bits`."""
        bits = bits or self.bits
        return Value(self.builder, ir.Constant(ir.IntType(bits), number & (1 << bits) - 1))

    def __add__(self, other: Value | int) -> Value:
        return self._with(self.builder.add, other)

    def __sub__(self, other: Value | int) -> Value:
        return self._with(self.builder.sub, other)

    def __mul__(self, other: Value | int) -> Value:
        return self._with(self.builder.mul, other)

    def __and__(self, other: Value | int) -> Value:
        return self._with(self.builder.and_, other)

    def __or__(self, other: Value | int) -> Value:
        return self._with(self.builder.or_, other)

    def __xor__(self, other: Value | int) -> Value:
        return self._with(self.builder.xor, other)

    def __invert__(self) -> Value:
        return self ^ -1

    def __neg__(self) -> Value:
        return self.constant(0) - self

    def shift_left(self, amount: Value | int) -> Value:
        """Shift left."""
        return self._with(self.builder.shl, amount)

    def shift_right(self, amount: Value | int) -> Value:
        """Shift right, zeros come in."""
        return self._with(self.builder.lshr, amount)

    def shift_right_signed(self, amount: Value | int) -> Value:
        """Shift right, copies of the sign come in."""
        return self._with(self.builder.ashr, amount)

    def equals(self, other: Value | int) -> Value:
        """Return one bit: whether they are equal."""
        return self._compared("==", other)

    def differs(self, other: Value | int) -> Value:
        """Return one bit: whether they are not equal."""
        return self._compared("!=", other)

    def __lt__(self, other: Value | int) -> Value:
        return self._compared("<", other)

    def __le__(self, other: Value | int) -> Value:
        return self._compared("<=", other)

    def __gt__(self, other: Value | int) -> Value:
        return self._compared(">", other)

    def __ge__(self, other: Value | int) -> Value:
        return self._compared(">=", other)

    def below(self, other: Value | int) -> Value:
        """Return one bit: whether it is less, without signs."""
        return self._compared("<", other, signed=False)

    def below_or_equal(self, other: Value | int) -> Value:
        """Return one bit: whether it is at most `other`, without signs."""
        return self._compared("<=", other, signed=False)

    def negative(self) -> Value:
        """Return one bit: the sign."""
        return self < 0

    def choose(self, yes: Value, no: Value | int) -> Value:
        """Return `yes` if this bit is set, else `no`."""
        return Value(self.builder, self.builder.select(self.ir, yes.ir, yes._as(no).ir))

    def smaller(self, other: Value | int) -> Value:
        """Return the smaller of two signed numbers."""
        return (self < other).choose(self, other)

    def larger(self, other: Value | int) -> Value:
        """Return the larger of two signed numbers."""
        return (self > other).choose(self, other)

    def leading_zeros(self) -> Value:
        """Return how many zeros are above the highest 1, in a value of the same width; the width if there is none."""
        return Value(self.builder, self.builder.ctlz(self.ir, ir.Constant(ir.IntType(1), 0)))

    def ones(self) -> Value:
        """Return how many bits are set, in a value of the same width."""
        return Value(self.builder, self.builder.ctpop(self.ir))

    def low(self, bits: int) -> Value:
        """Return the lowest `bits` bits."""
        return (
            self if bits == self.bits else Value(self.builder, self.builder.trunc(self.ir, ir.IntType(bits)))
        )

    def zero_extended(self, bits: int = 32) -> Value:
        """Return it with zeros above."""
        return (
            self if bits == self.bits else Value(self.builder, self.builder.zext(self.ir, ir.IntType(bits)))
        )

    def sign_extended(self, bits: int = 32) -> Value:
        """Return it with copies of the sign above."""
        return (
            self if bits == self.bits else Value(self.builder, self.builder.sext(self.ir, ir.IntType(bits)))
        )

    def reversed(self) -> Value:
        """Return its bits in the opposite order."""
        return Value(self.builder, self.builder.bitreverse(self.ir))

    def _as(self, other: Value | int) -> Value:
        return other if isinstance(other, Value) else self.constant(other)

    def _with(self, instruction: Any, other: Value | int) -> Value:
        return Value(self.builder, instruction(self.ir, self._as(other).ir))

    def _compared(self, relation: str, other: Value | int, *, signed: bool = True) -> Value:
        compare = self.builder.icmp_signed if signed else self.builder.icmp_unsigned
        return Value(self.builder, compare(relation, self.ir, self._as(other).ir))
