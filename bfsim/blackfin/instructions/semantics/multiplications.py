"""What the two multipliers do: products, and products added to or taken from the accumulators.

MAC1 works for A1 and for the high half or the odd register, MAC0 for A0 and the low half or the even register.
"""

from __future__ import annotations

from dataclasses import dataclass

from bfsim.blackfin.instructions.effects import Effects
from bfsim.blackfin.instructions.multipliers import ADDS, MOVES, MULTIPLIES, RESTS
from bfsim.blackfin.instructions.semantics.modes import Mode
from bfsim.blackfin.instructions.semantics.results import (
    any_of,
    half,
    set_overflow,
    set_zero_negative,
    write_half,
)
from bfsim.blackfin.instructions.semantics.saturation import saturated
from bfsim.blackfin.instructions.value import Value

SET, ADD, SUBTRACT = range(3)
"""What a product does to an accumulator, as the encoding counts it."""


@dataclass(frozen=True, slots=True)
class Multiplier:
    """What one of the two does: its number, its mode, what it `does` (`multipliers`), its operation and its factors."""

    number: int
    mode: Mode
    does: str
    operation: int
    factors: tuple[tuple[str, int], tuple[str, int]]
    """Each a register, and whether its high half is meant."""

    def result(self, fx: Effects) -> tuple[Value, Value]:
        """Do all but write the register; return in 64 bits its new value, and the number that decides if it overflows."""
        accumulator = f"A{self.number}"
        if self.does == MOVES:
            before = self.mode.widened(fx.read(accumulator))
            return before, before
        product = self.mode.product(*(half(fx, *each) for each in self.factors))
        if self.does == MULTIPLIES:
            return product, product
        clipped = product.constant(0, 1)
        if self.mode.name == "W32":
            near, clipped = saturated(product, 32)
            product = near.sign_extended(64)
        exact = self._sum(fx.read(accumulator), product)
        kept, over = self.mode.kept(exact, fx.read(accumulator))
        fx.write(accumulator, kept)
        set_overflow(fx, over | clipped, f"AV{self.number}")
        return kept, exact

    def _sum(self, before: Value, product: Value) -> Value:
        """Return the sum before it is saturated."""
        if self.operation == SET:
            return product
        return self.mode.widened(before) + (product if self.operation == ADD else -product)

    def extracted(self, fx: Effects, number: Value, wide: int) -> tuple[Value, Value]:
        """Return a 64-bit number as the register or its half gets it, and whether it did not fit."""
        return self.mode.register(number) if wide else self.mode.half(number, fx.read("RND_MOD"))

    def write(self, fx: Effects, d: str, wide: int, result: Value) -> None:
        """Write to a half of d, or to d or the register after it."""
        if wide:
            fx.write(f"R{int(d[1]) + self.number}", result)
        else:
            write_half(fx, d, self.number, result)


def multiply_accumulate(
    fx: Effects, m: str, x: int, mac1: str, mac0: str, wide: int, d: str = "", s: str = "", t: str = "",
    o: int = SET, a: int = 0, b: int = 0, n: int = SET, c: int = 0, e: int = 0,
) -> None:  # fmt: skip
    """R0.H = (A1 += R1.H * R2.L) (M), R0.L = R1.L * R2.L (IS)."""
    overs, moved = [], []
    for unit in (
        Multiplier(1, Mode(m, mixed=bool(x)), mac1, o, ((s, a), (t, b))),
        Multiplier(0, Mode(m), mac0, n, ((s, c), (t, e))),
    ):
        if unit.does == RESTS:
            continue
        number, exact = unit.result(fx)
        if unit.does == ADDS:
            continue
        result, _ = unit.extracted(fx, number, wide)
        unit.write(fx, d, wide, result)
        overs.append(unit.extracted(fx, exact, wide)[1])
        if unit.does == MOVES:
            moved.append(result)
    if overs:
        set_overflow(fx, any_of(overs))
    if moved:
        set_zero_negative(fx, *moved)
