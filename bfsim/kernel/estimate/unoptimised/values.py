"""The operations of an expression at -O0: variables are loaded where they are used, and nothing is remembered.

Operands that are neither variables nor numbers are computed first, from the left; variables and numbers follow, just
before the operation. Patterns and immediates are those of bfin.md of GCC 12.
"""

from __future__ import annotations

from bfsim.kernel.estimate.unoptimised.addresses import offset_of
from bfsim.kernel.estimate.unoptimised.calls import call, divide
from bfsim.kernel.estimate.unoptimised.computing import Computing
from bfsim.kernel.estimate.unoptimised.constants import product
from bfsim.kernel.estimate.unoptimised.expressions import BITWISE, DIVISIONS, Expr, rotated
from bfsim.kernel.estimate.unoptimised.intrinsics import intrinsic, word
from bfsim.kernel.estimate.unoptimised.registers import HALF, MODIFIERS
from bfsim.kernel.estimate.unoptimised.stores import low_bits_of
from bfsim.kernel.ir.widths import WORD
from bfsim.kernel.operations import ADD_IMMEDIATE, COMPARE_IMMEDIATE, COMPARE_UNSIGNED_IMMEDIATE, Op

LOADS = {1: Op.LOAD8, 8: Op.LOAD8, 16: Op.LOAD16, 32: Op.LOAD32}
ZERO_EXTENSIONS = (0xFF, 0xFFFF)  # R.B (Z), R.L (Z)
OPERATIONS = {"-": Op.ALU, "neg": Op.ALU, "inverse": Op.ALU, "abs": Op.DSP_ALU}


class ExpressionCode(Computing):
    """Computes expressions: for each kind, its operations."""

    def value(self, each: Expr, *, adds: bool = False, waits: bool = False, outermost: bool = False) -> bool:
        match each.op:
            case "const":
                self.number(each.value, pointer=adds)
                return adds
            case "register":
                return False
            case "+":
                return self._sum(each, adds=adds, waits=waits)
            case "*" if each.args[1].is_const:
                return self._multiple(each, adds=adds)
        if each.op == "*":
            self._product(*each.args, waits=waits, outermost=outermost)
        else:
            self._data(each)
        self.move(int(each.is_call and adds))
        return each.is_call and adds

    def copied(self, each: Expr) -> None:
        """Compute a function's result: a copy of the computed value."""
        self.move(int(self.value(each, adds=not (each.is_call or each.is_leaf))))

    def _product(self, left: Expr, right: Expr, *, waits: bool, outermost: bool) -> None:
        """Multiply. A register that is changed in place is copied first, if anything else is around."""
        self.move(
            int((left == right and waits) or (left.is_in_place and right.op == "local" and not outermost))
        )
        self._operands(left, right)
        self.op(Op.MUL32)

    def _data(self, each: Expr) -> None:
        """Compute a value that only data registers can hold."""
        if each.op in DIVISIONS:
            divide(self, each)
        elif each.op in BITWISE:
            self._bitwise(each)
        elif each.op in OPERATIONS:
            self._operands(*each.args, in_order=each.op == "-")
            self.op(OPERATIONS[each.op])
        else:
            handlers = {
                "local": self._local, "decided": self._decided, "load": self.load, "call": self._call,
                "widen": self._cast, "narrow": self._cast, "compare": self._truth, "not": self._truth,
                "<<": self._shift, ">>": self._shift, "intrinsic": self._intrinsic, "word": self._word,
                "differ": self._differ,
                "min": self._extreme, "max": self._extreme, "umin": self._extreme, "umax": self._extreme,
            }  # fmt: skip
            handlers[each.op](each)

    def _local(self, each: Expr) -> None:
        self.op(LOADS[each.bits])

    def _call(self, each: Expr) -> None:
        call(self, each)

    def _intrinsic(self, each: Expr) -> None:
        intrinsic(self, each)

    def _word(self, each: Expr) -> None:
        word(self, each)

    def _decided(self, _each: Expr) -> None:
        """What `and` and `or` decided, as a number."""
        self.op(Op.IMM, Op.JUMP)  # R = 1; JUMP past R = 0

    def _truth(self, each: Expr) -> None:
        self.condition(each)
        self.op(Op.CC_MOVE)

    def _differ(self, each: Expr) -> None:
        """Whether two truth values differ, as bits: CC has no comparison with more than a number, so that one is inverted afterwards."""
        for part in each.args:
            self._truth(part)
            is_inverted = part.name == "ne" or (part.args[1].is_const and part.name[1:] in ("gt", "ge"))
            self.op(*(Op.ALU,) * is_inverted)
        self.op(Op.MOVE, Op.ALU, Op.EXTEND)

    def _extreme(self, each: Expr) -> None:
        """Minimum or maximum: an instruction for signed words only; GCC compares bytes as bytes."""
        self._operands(*each.args)
        if each.op in ("umin", "umax"):
            self.op(Op.MOVE, Op.COMPARE, Op.COND_MOVE)
        elif all(part.is_loaded_narrow and part.unsigned for part in each.args):
            self.op(Op.COMPARE, Op.COND_MOVE, Op.EXTEND)
        else:
            self.op(Op.DSP_ALU)

    def _operands(self, left: Expr, right: Expr | None = None, *, in_order: bool = False) -> None:
        """Both sides in data registers. `in_order`: they cannot be swapped."""
        if right is None:
            self.value(left)
            return
        self._save(left, right, "R7")
        for each, other in ((left, right), (right, left)):
            if not each.is_leaf:
                taken = not other.is_leaf or (in_order and other.op == "local")
                self.value(each, waits=each is left and taken)
                self.move(int(each.is_call and (other.op == "local" or other.calls)))
        for each in (left,) if left == right else (left, right):
            if each.is_leaf:
                self.value(each)

    def _save(self, left: Expr, right: Expr, register: str) -> None:
        """Note that a value that waits during a call needs a register that calls preserve."""
        if not left.is_leaf and right.calls:
            self.saved.add(register)

    def _sum(self, each: Expr, *, adds: bool, waits: bool) -> bool:
        left, right = each.args
        if right.is_const and right.value in ADD_IMMEDIATE:
            pointer = self.value(left, adds=right.value in MODIFIERS)
            to_pointer = adds and right.value in MODIFIERS
            return self.add_number(right.value, pointer=pointer, to_pointer=to_pointer, waits=waits)
        self._save(left, right, "P5")
        pointers = []
        for part in sorted((left, right), key=lambda part: part.is_leaf):
            pointers.append(self.value(part, adds=True, waits=part is left and (adds or not right.is_leaf)))
        return self.add(pointers, to_pointer=adds)

    def _multiple(self, each: Expr, *, adds: bool) -> bool:
        self.value(each.args[0])
        plan = product(each.args[1].value)
        if plan is None:
            self.number(each.args[1].value)
            self.op(Op.MUL32)
            return False
        self.op(*plan.ops)
        self.move(int(adds and plan.is_sum))
        return adds and plan.is_sum

    def _cast(self, each: Expr) -> None:
        inner = each.args[0]
        if inner.op == "narrow":
            self.move(int(low_bits_of(self, inner.args[0], each, late=False)))
        else:
            self.value(inner)
        if each.op == "widen":
            self.op(Op.EXTEND)

    def _shift(self, each: Expr) -> None:
        left, right = each.args
        if not right.is_const:
            self._operands(left, right)
            self.op(Op.SHIFT)
            return
        self.value(left)
        self.op(Op.SHIFT)
        if each.op == ">>" and left.is_loaded_narrow:
            self.op(Op.EXTEND)  # GCC shifts the narrow value, and extends it again

    def _bitwise(self, each: Expr) -> None:
        left, right = each.args
        if right.is_const:
            self._masked(each.op, left, right.value)
        elif each.op == "|" and (rotation := rotated(each)):
            self.value(rotation[0])
            self.op(
                *((Op.DSP_ALU,) if rotation[1] == HALF else (Op.SHIFT, Op.SHIFT, Op.ALU))
            )  # R = PACK(R.L, R.H)
        elif left.is_loaded_narrow and right.is_loaded_narrow and left.bits == right.bits:
            self._operands(left.args[0], right.args[0])
            self.op(Op.ALU, Op.EXTEND)
        else:
            self._operands(left, right)
            self.op(Op.ALU)

    def _masked(self, op: str, value: Expr, mask: int) -> None:
        """Combine with a constant: an extension, BITSET, BITCLR or BITTGL, or the constant in a register."""
        one_bit = (~mask if op == "&" else mask) % (1 << WORD)
        if op == "&" and mask in ZERO_EXTENSIONS:
            self.value(value)
            self.op(Op.EXTEND)
        elif one_bit.bit_count() == 1:
            self.value(value)
            self.op(Op.ALU)
        else:
            self.value(value, waits=True)
            self.number(mask)
            self.op(Op.ALU)

    def load(self, each: Expr) -> None:
        """Load an element of an array, not extended. A number as index needs no address: R = [P + n]."""
        if each.args[0].is_const:
            self.op(Op.LOAD32)
        else:
            self.address(each)
        self.op(LOADS[each.bits])
        self.makes(each)

    def address(self, element: Expr) -> None:
        self.op(Op.LOAD32)
        index, size = element.args[0], element.bits // 8
        if not index.is_const:
            self.add([False, offset_of(self, index, size)], to_pointer=True)
        elif index.value:
            self.add_number(index.value * size, pointer=False, to_pointer=True)

    def condition(self, each: Expr) -> None:
        """Compute a truth value into CC. Whether CC or its opposite is meant costs nothing."""
        if each.op == "not":
            self.condition(each.args[0])
            return
        if each.op == "compare":
            left, right = each.args
            unsigned = each.name[0] == "u" or (left.op == "widen" and left.unsigned)
            if right.is_const and right.value in (
                COMPARE_UNSIGNED_IMMEDIATE if unsigned else COMPARE_IMMEDIATE
            ):
                self.value(left)
            else:
                self._operands(left, right)
        else:
            self.value(each)
        self.op(Op.COMPARE)
