"""Expressions as GCC's front end leaves them: it folds them before any operation is chosen, even at -O0."""

from __future__ import annotations

from dataclasses import dataclass, field

from bfsim.kernel.estimate.arithmetic.powers import by_power
from bfsim.kernel.ir.text import INVERTED, SWAPPED, Instruction, SourceLine
from bfsim.kernel.ir.widths import WORD
from bfsim.kernel.operations import ADD_IMMEDIATE, Op

SIGN = 1 << (WORD - 1)
DIVISIONS = ("sdiv", "srem", "udiv", "urem")
BITWISE = ("&", "|", "^")


@dataclass(frozen=True, slots=True)
class Expr:
    """A value. `op`: const, local, register, load, widen, narrow, compare, differ, not, call, or an operator of ARITHMETIC."""

    op: str
    args: tuple[Expr, ...] = ()
    value: int = 0
    name: str = ""
    """Variable, array, called function, or predicate of a comparison."""
    bits: int = 32
    unsigned: bool = False
    access: Instruction | None = field(default=None, compare=False)
    """For an element: the load or store of the IR."""

    @property
    def is_const(self) -> bool:
        """Whether it is a number."""
        return self.op == "const"

    @property
    def is_leaf(self) -> bool:
        """Whether it is only read where it is needed: a number or a variable."""
        return self.op in ("const", "local")

    @property
    def is_call(self) -> bool:
        """Whether a function of the library or another kernel returns it."""
        if self.op not in DIVISIONS or not self.args[1].is_const:
            return self.op in ("call", *DIVISIONS)
        return self.op[0] == "s" and by_power(self.op, self.args[1].value, Op.BRANCH_TAKEN) is None

    @property
    def calls(self) -> bool:
        """Whether it or a part of it comes from a call."""
        return self.is_call or any(each.calls for each in self.args)

    @property
    def is_in_place(self) -> bool:
        """Whether its operation changes a register: what the register held must be copied if it is needed elsewhere."""
        if self.op == "+":
            return self.args[1].is_const and self.args[1].value in ADD_IMMEDIATE
        return self.op == "*" and self.args[0] == self.args[1]

    @property
    def is_loaded_narrow(self) -> bool:
        """Whether it is an element of few bits, extended."""
        return self.op == "widen" and self.args[0].op == "load"


@dataclass(frozen=True, slots=True)
class TreeStatement:
    """A statement of a block: `target` is what is written, a local or a load, or None."""

    value: Expr
    target: Expr | None
    line: SourceLine


def const(value: int) -> Expr:
    """Return a number."""
    return Expr("const", value=value)


def simplified(op: str, left: Expr, right: Expr, *, unsigned: bool = False) -> Expr:
    """Write an operation as GCC's front end does: numbers on the right, no subtraction of one, no product with 2**n."""
    if left.is_const and op in "+*&|^":
        left, right = right, left
    if op == "-" and left == const(0):
        return Expr("neg", (right,))
    if op == "^" and right == const(-1):
        return Expr("inverse", (left,))
    if op == "-" and right.is_const:
        op, right = "+", const(-right.value)
    if op == "*" and right.is_const and right.value > 0 and right.value.bit_count() == 1:
        op, right = "<<", const(right.value.bit_length() - 1)
    if op in ("udiv", "urem") and right.is_const and right.value.bit_count() == 1:
        power = right.value
        op, right = (">>", const(power.bit_length() - 1)) if op == "udiv" else ("&", const(power - 1))
    if op == "+" and right.is_const and left.op == "+" and left.args[1].is_const:
        left, right = left.args[0], const(left.args[1].value + right.value)
    return Expr(op, (left, right), unsigned=unsigned)


def compare(predicate: str, left: Expr, right: Expr) -> Expr:
    """Write a comparison as GCC's front end does: numbers on the right and near zero, single bits as tests of a mask."""
    if left.op == right.op == "compare":
        return _compared_truths(predicate, left, right)
    if left.is_const:
        predicate, left, right = SWAPPED[predicate], right, left
    if predicate[0] == "s":
        left, right = _without_one(predicate, left, right)
    if right.is_const and left.op == "+" and left.args[1].is_const and predicate[0] in "se":
        left, right = left.args[0], const(right.value - left.args[1].value)
    if right.is_const:
        right = const(_nearest_zero(predicate, right.value))
        if left.op == "&" and left.args[1].is_const:
            left, right = _bit_test(predicate, left, right)
    return Expr("compare", (left, right), name=predicate)


def _compared_truths(predicate: str, left: Expr, right: Expr) -> Expr:
    """Compare two comparisons: two signs as the sign of a ^ b, others as a ^ b, with the first inverted if they are to be equal."""
    signs = [
        each.args[0] for each in (left, right) if each.name in ("slt", "sge") and each.args[1] == const(0)
    ]
    if len(signs) == 2:
        inversions = (predicate == "eq") + (left.name == "sge") + (right.name == "sge")
        return Expr("compare", (Expr("^", tuple(signs)), const(0)), name="sge" if inversions % 2 else "slt")
    if predicate == "eq":
        left = Expr("compare", left.args, name=INVERTED[left.name])
    return Expr("differ", (left, right))


def _without_one(predicate: str, left: Expr, right: Expr) -> tuple[Expr, Expr]:
    """Write a + 1 > b as a >= b, and the like [maybe_canonicalize_comparison of fold-const.cc]."""
    for mine, other, test in ((left, right, predicate), (right, left, SWAPPED[predicate])):
        one = const(1 if test in ("sgt", "sle") else -1)
        if mine.op == "+" and mine.args[1] == one and not other.is_const:
            return (mine.args[0], right) if mine is left else (left, mine.args[0])
    return left, right


def _nearest_zero(predicate: str, value: int) -> int:
    if predicate in ("slt", "sge", "ult", "uge"):
        return value - 1 if value > 0 else value
    if predicate in ("sle", "sgt"):
        return value + 1 if value < 0 else value
    return value


def _bit_test(predicate: str, masked: Expr, right: Expr) -> tuple[Expr, Expr]:
    """Test a single bit: bit 6 for (a & 127) < 64, bit 3 for (a >> 3) & 1; bit 31 by the sign."""
    inner, mask = masked.args
    half = (mask.value + 1) // 2
    is_order = predicate in ("slt", "sge", "sgt", "sle")
    if is_order and mask.value == 2 * half - 1 and right.value == half - 1 > 0:
        return Expr("&", (inner, const(half))), const(0)
    if predicate not in ("eq", "ne") or right != const(0):
        return masked, right
    if mask.value in (SIGN, -SIGN):
        return inner, right
    if inner.op == ">>" and inner.args[1].is_const and mask.value.bit_count() == 1:
        return Expr("&", (inner.args[0], const(mask.value << inner.args[1].value))), right
    return masked, right


def rotated(either: Expr) -> tuple[Expr, int] | None:
    """Return what `either` rotates and by how many bits, if it is (a << n) | (a >> 32 - n)."""
    left, right = sorted(either.args, key=lambda each: each.op)
    if left.op != "<<" or right.op != ">>" or not right.unsigned or left.args[0] != right.args[0]:
        return None
    counts = left.args[1], right.args[1]
    is_rotation = all(each.is_const for each in counts) and counts[0].value + counts[1].value == WORD
    return (left.args[0], counts[0].value) if is_rotation else None


def extreme_of(predicate: str, operands: list[Expr], sides: list[Expr]) -> Expr | None:
    """Return the minimum that a < b ? a : b is, or the absolute value that a < 0 ? -a : a is [fold_cond_expr_with_comparison]."""
    left, right = operands
    if predicate not in ("slt", "sle", "sgt", "sge"):
        return None
    smaller = predicate in ("slt", "sle")
    if sides == operands:
        return Expr("min" if smaller else "max", (left, right))
    if sides == operands[::-1]:
        return Expr("max" if smaller else "min", (left, right))
    below_zero, above_zero = sides if smaller else sides[::-1]
    is_absolute = right == const(0) and below_zero == Expr("neg", (left,)) and above_zero == left
    return Expr("abs", (left,)) if is_absolute else None
