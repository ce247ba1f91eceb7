"""Addresses that code puts together from two halves, as in `R0.L = place; R0.H = place;`: code holds them in no other way."""

from __future__ import annotations

from collections.abc import Iterable

from bfsim.blackfin.instructions.decode import Instruction

BITS = 16
HALVES = {"set_high", "set_low"}


class PutTogether:
    """The 32-bit numbers whose halves are both in `instructions`, whichever registers they are put into."""

    def __init__(self, instructions: Iterable[Instruction]) -> None:
        found: dict[str, set[int]] = {each: set() for each in HALVES}
        for instruction in instructions:
            for each in instruction.operations:
                if each.form.does in HALVES:
                    found[each.form.does].add(int(each.operands["i"]))
        self._high, self._low = found["set_high"], found["set_low"]

    def __contains__(self, number: int) -> bool:
        """Whether code may put this number together."""
        return number >> BITS in self._high and number % (1 << BITS) in self._low
