"""Value numbering: values computed in the same way from the same values are one, by the name of the first."""

from __future__ import annotations

from bfsim.kernel.ir.text import Instruction

COMPUTED = {
    "getelementptr", "add", "sub", "mul", "shl", "lshr", "ashr", "and", "or", "xor", "sext", "zext", "trunc",
}  # fmt: skip
FLAGS = frozenset({"nuw", "nsw", "exact", "disjoint", "nneg", "inbounds"})
"""What LLVM knows of a result; it does not change the value."""


class ValueNumbers:
    """Names of equal values. Instructions are added in an order in which each value comes before its uses, except in phis."""

    def __init__(self) -> None:
        self._first: dict[str, str] = {}
        self._computed: dict[tuple[str, ...], str] = {}

    def of(self, value: str) -> str:
        """Return the name of the first value that is the same."""
        return self._first.get(value, value)

    def add(self, each: Instruction) -> None:
        """Note what an instruction computes."""
        if each.result and each.opcode in COMPUTED:
            kinds = (word for word in each.text.split() if not word.startswith("%") and word not in FLAGS)
            key = (*kinds, *map(self.of, each.operands))
            self._first[each.result] = self._computed.setdefault(key, each.result)

    def equate(self, value: str, first: str) -> None:
        """Note that a value equals an earlier one."""
        self._first[value] = first
