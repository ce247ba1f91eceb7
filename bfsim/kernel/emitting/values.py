"""Expressions of the typed tree → LLVM IR, for `emit`: where each stands, and which of them can go wrong in a run."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from llvmlite import ir

from bfsim.kernel.emitting import divisions, floats
from bfsim.kernel.emitting.floats import register_type
from bfsim.kernel.intrinsics.meaning import function_type
from bfsim.kernel.ir.text import COUNTS, ENTERS, HOLDS, NO_HINT, STEPS
from bfsim.kernel.language import tree
from bfsim.kernel.language.function import Function
from bfsim.kernel.types import FloatType, IntType, Number, u32

InlinedCall = tuple[str, str, int]
"""Symbols of caller and callee, and the line in the caller."""
Site = tree.Load | tree.Store | tree.Binary | tree.For
"""An access, a division, or a loop whose step is not constant: what can go wrong in a run."""
I1, I32 = ir.IntType(1), ir.IntType(32)
WRAPPING = (
    "wrapping"  # names negations of u32; that of a negative i32 is positive, for it does not overflow in C
)
SIMPLE = {"+": "add", "-": "sub", "*": "mul", "&": "and_", "|": "or_", "^": "xor"}
# [predict.def of GCC 12] hit rates 67 % (continue) and 66 % (early return); both sides even otherwise
CONTINUES, RETURNS, GOES_ON = 33, 34, 67
EVEN = (GOES_ON, GOES_ON)
WORD_BITS = 32
SHIFT_MASK = 31  # a shift count uses its low five bits; the language refuses constants outside 0..31
MOST_SITES = (1 << 16) - 1  # LLVM keeps 16 bits of a column


@dataclass(slots=True)
class Values:
    """Emits what `function` computes, at the place of `builder`."""

    builder: ir.IRBuilder
    function: Function
    inlined: frozenset[InlinedCall]
    scope: ir.values.MDValue
    arrays: dict[str, tuple[ir.Value, ir.Value]]
    """Where each begins, and its length."""
    slots: dict[str, ir.Value] = field(init=False, default_factory=dict)
    """Where each local is kept."""
    sites: list[Site] = field(init=False, default_factory=list)
    weights: tuple[int, int] = field(init=False, default=EVEN)
    """How likely the `if` whose condition is being emitted is true, and false."""
    _line: int = field(init=False, default=1)

    def at(self, line: int, site: int = 0) -> None:
        """Make a line of the kernel the source of what is emitted from now on."""
        self._line = line
        self.builder.debug_metadata = self.builder.module.add_debug_info(
            "DILocation", {"line": line, "column": site if site <= MOST_SITES else 0, "scope": self.scope}
        )

    @contextmanager
    def site(self, node: Site) -> Iterator[None]:
        """Give what is emitted inside the number of the site `node`."""
        self.sites.append(node)
        self.at(self._line, len(self.sites))
        yield
        self.at(self._line)

    def hint(self, branch: ir.Instruction) -> None:
        """Tell LLVM how likely the `if` is, at the branch that decides it."""
        if self.weights[0] != self.weights[1]:
            branch.set_weights(self.weights)

    def entry_slot(self, kind: ir.Type, name: str = "") -> ir.Value:
        """Return a slot at the head of the first block: after an inlined call, LLVM would leave it in memory."""
        entry = self.builder.function.entry_basic_block
        before = next((each for each in entry.instructions if each.opname != "alloca"), None)
        with self.builder.goto_block(entry):
            if before is not None:
                self.builder.position_before(before)
            return self.builder.alloca(kind, name=name)

    def value(self, node: tree.Expr) -> ir.Value:
        """Emit `node`; an i32, or an i1 when it is a truth value."""
        result: ir.Value = getattr(self, f"_{type(node).__name__.lower()}")(node)
        return result

    def _const(self, node: tree.Const) -> ir.Value:
        return register_type(node.type)(node.value)

    def _local(self, node: tree.Local) -> ir.Value:
        return self.builder.load(self.slots[node.name], typ=register_type(node.type))

    def _length(self, node: tree.Length) -> ir.Value:
        return self.arrays[node.array][1]

    def address(self, array: str, element: Number, index: tree.Expr) -> ir.Value:
        """Emit the address of an element."""
        pointer, _ = self.arrays[array]
        return self.builder.gep(pointer, [self.value(index)], source_etype=ir.IntType(element.bits))

    def _load(self, node: tree.Load) -> ir.Value:
        address = self.address(node.array, node.element, node.index)
        is_float = isinstance(node.element, FloatType)
        with self.site(node):
            value = self.builder.load(
                address, typ=floats.FLOAT if is_float else ir.IntType(node.element.bits)
            )
        return self._extend(value, node.element) if isinstance(node.element, IntType) else value

    def _extend(self, value: ir.Value, kind: IntType) -> ir.Value:
        if kind.bits == WORD_BITS:
            return value
        return self.builder.sext(value, I32) if kind.signed else self.builder.zext(value, I32)

    def _cast(self, node: tree.Cast) -> ir.Value:
        value = self.value(node.operand)
        if isinstance(node.to, FloatType) or isinstance(node.operand.type, FloatType):
            assert node.operand.type
            return floats.convert(self.builder, value, node.operand.type, node.to, self._float_intrinsic)
        if node.to.bits == WORD_BITS:
            return value
        return self._extend(self.builder.trunc(value, ir.IntType(node.to.bits)), node.to)

    def _unary(self, node: tree.Unary) -> ir.Value:
        value = self.value(node.operand)
        if isinstance(node.type, FloatType):
            return floats.unary(self.builder, node.op, value, self._float_intrinsic)
        if node.op == "-":
            return self.builder.neg(value, name=WRAPPING if node.type is u32 else "")
        if node.op == "~":
            return self.builder.not_(value)
        return self._intrinsic("llvm.abs.i32", [I32, I1], [value, I1(0)])

    def _float_intrinsic(self, name: str, result: ir.Type, arguments: list[ir.Value]) -> ir.Value:
        kind = ir.FunctionType(result, [each.type for each in arguments])
        return self.builder.call(
            self.builder.module.globals.get(name) or ir.Function(self.builder.module, kind, name), arguments
        )

    def _intrinsic(self, name: str, types: list[ir.Type], arguments: list[ir.Value]) -> ir.Value:
        target = self.builder.module.globals.get(name) or ir.Function(
            self.builder.module, ir.FunctionType(I32, types), name
        )
        return self.builder.call(target, arguments)

    def _binary(self, node: tree.Binary) -> ir.Value:
        left, right = self.value(node.left), self.value(node.right)
        if isinstance(node.type, FloatType):
            return floats.binary(self.builder, node.op, left, right)
        unsigned = node.type is u32
        if node.op in SIMPLE:
            negates = (
                unsigned and node.op == "-" and isinstance(node.left, tree.Const) and not node.left.value
            )
            return getattr(self.builder, SIMPLE[node.op])(left, right, name=WRAPPING if negates else "")
        if node.op in ("<<", ">>"):
            return self._shift(node, left, right)
        if node.op in ("min", "max"):
            return self._intrinsic(f"llvm.{'u' if unsigned else 's'}{node.op}.i32", [I32, I32], [left, right])
        with self.site(node):
            if unsigned:
                return divisions.unsigned(self.builder, node.op, left, right)
            constant = int(node.right.value) if isinstance(node.right, tree.Const) else None
            return divisions.signed(self.builder, node.op, left, right, constant)

    def _shift(self, node: tree.Binary, left: ir.Value, right: ir.Value) -> ir.Value:
        if not _is_within_word(node.right):
            right = self.builder.and_(right, I32(SHIFT_MASK), COUNTS)
        if node.op == "<<":
            return self.builder.shl(left, right)
        return (self.builder.lshr if node.type is u32 else self.builder.ashr)(left, right)

    def _compare(self, node: tree.Compare) -> ir.Value:
        left, right = self.value(node.left), self.value(node.right)
        if isinstance(node.left.type, FloatType):
            return floats.compare(self.builder, node.op, left, right)
        if node.left.type is u32:
            return self.builder.icmp_unsigned(node.op, left, right)
        return self.builder.icmp_signed(node.op, left, right)

    def _logic(self, node: tree.Logic) -> ir.Value:
        """Emit `and` or `or`: the right side runs only if the left one does not decide."""
        slot = self._decided(node.left)
        more, after = (self.builder.append_basic_block(name) for name in (node.op, "decided"))
        left = self.builder.load(slot, typ=I1)
        branch = self.builder.cbranch(left, *((more, after) if node.op == "and" else (after, more)))
        if self._decides_alone(node.op):
            self.hint(branch)
        else:
            branch.set_weights(NO_HINT if node.op == "and" else NO_HINT[::-1])
        self.builder.position_at_end(more)
        self.builder.store(self.value(node.right), slot)
        self.builder.branch(after)
        self.builder.position_at_end(after)
        return self.builder.load(slot, typ=I1)

    def _decides_alone(self, op: str) -> bool:
        """Whether the left side of `and` or `or` alone may lead to a `continue`: if not, the hint belongs to the right side.

        [predict_paths_leading_to in predict.cc of GCC 12.] The hint of a `return` stays with both sides.
        """
        yes, no = self.weights
        return min(yes, no) != CONTINUES or yes == no or (yes < no) == (op == "or")

    def _decided(self, node: tree.Expr) -> ir.Value:
        value = self.value(node)
        slot = self.entry_slot(I1)
        self.builder.store(value, slot)
        return slot

    def _not(self, node: tree.Not) -> ir.Value:
        return self.builder.not_(self.value(node.operand))

    def _choose(self, node: tree.Choose) -> ir.Value:
        """Emit a choice: only the chosen side runs, as in Python."""
        slot = self.entry_slot(register_type(node.type), "chosen")
        yes, no, after = (self.builder.append_basic_block(name) for name in ("yes", "no", "chosen"))
        self.builder.cbranch(self.value(node.test), yes, no)
        for block, side in ((yes, node.yes), (no, node.no)):
            self.builder.position_at_end(block)
            self.builder.store(self.value(side), slot)
            self.builder.branch(after)
        self.builder.position_at_end(after)
        return self.builder.load(slot, typ=register_type(node.type))

    def _intrinsiccall(self, node: tree.IntrinsicCall) -> ir.Value:
        """Emit a call of a function that gets its body when the code is compiled for the host; to LLVM it only computes."""
        intrinsic = node.intrinsic
        target = self.builder.module.globals.get(intrinsic.symbol)
        if target is None:
            target = ir.Function(self.builder.module, function_type(intrinsic), intrinsic.symbol)
            target.attributes.add("readnone")
            target.attributes.add("nounwind")
        values = [
            self.builder.trunc(self.value(each), ir.IntType(kind.bits))
            if kind.bits < WORD_BITS
            else self.value(each)
            for each, kind in zip(node.arguments, intrinsic.takes, strict=True)
        ]
        result = self.builder.call(target, values)
        return self._extend(result, intrinsic.gives) if isinstance(intrinsic.gives, IntType) else result

    def _word(self, node: tree.Word) -> ir.Value:
        pair = self.value(node.pair)
        return self.builder.trunc(self.builder.lshr(pair, pair.type(WORD_BITS)) if node.upper else pair, I32)

    def _kernelcall(self, node: tree.KernelCall) -> ir.Value:
        arguments: list[ir.Value] = []
        for each in node.arguments:
            arguments.extend(self.arrays[each] if isinstance(each, str) else [self.value(each)])
        result: ir.Value = self.builder.call(
            self.builder.module.get_global(node.callee.symbol), arguments, attrs=self._entered(node)
        )
        return result

    def _entered(self, node: tree.KernelCall) -> tuple[str, ...]:
        """Mark where the code of an inlined kernel begins; return the attributes of its call for LLVM."""
        callee = node.callee.symbol
        if (self.function.symbol, callee, node.line) not in self.inlined:
            return ()
        self._mark(f"{ENTERS}{callee}")
        return ("alwaysinline",)

    def steps(self, node: tree.For, *bounds: ir.Value) -> None:
        """Mark the beginning of a loop whose start, stop and step are to be checked."""
        with self.site(node):
            self._mark(STEPS, *bounds)

    def hold(self) -> None:
        """Mark the loop that begins here as one that is not to be rotated."""
        self._mark(HOLDS)
        self.builder.module.globals[HOLDS].attributes.add("noduplicate")

    def _mark(self, name: str, *given: ir.Value) -> None:
        """Emit a call that does nothing: it stays in its block and hinders no other instruction."""
        mark = self.builder.module.globals.get(name)
        if mark is None:
            kind = ir.FunctionType(ir.VoidType(), [each.type for each in given])
            mark = ir.Function(self.builder.module, kind, name)
            mark.attributes.add("inaccessiblememonly")
            mark.attributes.add("nounwind")
        self.builder.call(mark, given)


def _is_within_word(count: tree.Expr) -> bool:
    """Whether the source shows that a value is shifted by less than a word: by a constant, or by low bits of something."""
    if isinstance(count, tree.Cast):
        return isinstance(count.to, IntType) and count.to.bits == WORD_BITS and _is_within_word(count.operand)
    if isinstance(count, tree.Binary) and count.op == "&":
        return any(
            isinstance(each, tree.Const) and 0 <= each.value <= SHIFT_MASK
            for each in (count.left, count.right)
        )
    return isinstance(count, tree.Const)
