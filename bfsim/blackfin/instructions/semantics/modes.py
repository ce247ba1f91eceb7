"""Modes of multiplications: what the factors are, where an accumulator saturates, and which part of it a register gets.

Programming reference, chapter 15, "Multiply options"; in doubt as GNU's simulator does. Products and accumulators have 64 bits here.
"""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.blackfin.instructions.semantics.saturation import rounded, saturated, saturated_unsigned
from bfsim.blackfin.instructions.value import Value

UNSIGNED = ("FU", "TFU", "IU")
FRACTIONS = ("", "S2RND", "T", "W32")
"""Modes of signed fractions, 1.15: their products are doubled, so that the point is where an accumulator has it."""
DOUBLED = ("S2RND", "ISS2")
TRUNCATED = ("T", "TFU")
INTEGERS = ("IS", "ISS2", "IU")
"""Modes in which a half register gets the lowest 16 bits; in the others it gets bits 16 to 31."""
ACCUMULATOR = 0xFFFFFFFFFF
"""40 bits."""


@dataclass(frozen=True, slots=True)
class Mode:
    """An option of a multiplication, by its name in assembler. `mixed`: with (M), only the second factor is unsigned."""

    name: str
    mixed: bool = False

    @property
    def is_signed(self) -> bool:
        """Whether products and accumulators are signed."""
        return self.mixed or self.name not in UNSIGNED

    def product(self, first: Value, second: Value) -> Value:
        """Return the product of two 16-bit factors."""
        one = first.sign_extended(64) if self.is_signed else first.zero_extended(64)
        other = second.sign_extended(64) if self.is_signed and not self.mixed else second.zero_extended(64)
        exact = one * other
        return exact.shift_left(1) if self.name in FRACTIONS and not self.mixed else exact

    def widened(self, accumulator: Value) -> Value:
        """Return the value of an accumulator, given sign-extended."""
        return accumulator if self.is_signed else accumulator & ACCUMULATOR

    def kept(self, exact: Value, before: Value) -> tuple[Value, Value]:
        """Return a sum as the accumulator keeps it, and whether it saturated; `before` is the accumulator as it was."""
        if self.name == "W32":
            # GNU's simulator saturates towards the sign that the accumulator had.
            fits = exact.low(32).sign_extended(64).equals(exact)
            limit = before.negative().choose(exact.constant(-0x80000000), exact.constant(0x7FFFFFFF))
            return fits.choose(exact, limit), ~fits
        if self.name == "IU" and self.mixed:
            return exact.shift_left(24).shift_right_signed(24), exact.constant(0, 1)
        if not self.is_signed:
            near = exact.larger(0).smaller(ACCUMULATOR)
            return near, near.differs(exact)
        near, over = saturated(exact, 32 if self.name == "IH" else 40)
        return near.sign_extended(64), over

    def register(self, number: Value) -> tuple[Value, Value]:
        """Return a product or accumulator as a register gets it, in 32 bits, and whether it did not fit."""
        return self._fitted(self._scaled(number), 32)

    def half(self, number: Value, biased: Value) -> tuple[Value, Value]:
        """Return a product or accumulator as a half register gets it, in 16 bits, and whether it did not fit."""
        number = self._scaled(number)
        if self.name in TRUNCATED:
            number = number.shift_right_signed(16)
        elif self.name not in INTEGERS:
            number = rounded(number, biased)
        return self._fitted(number, 16)

    def _scaled(self, number: Value) -> Value:
        return number.shift_left(1) if self.name in DOUBLED else number

    def _fitted(self, number: Value, bits: int) -> tuple[Value, Value]:
        return saturated(number, bits) if self.is_signed else saturated_unsigned(number, bits)
