"""Typed tree → LLVM IR, unoptimised: every local in a stack slot, one debug line per statement.

An array is a plain pointer and its length; a call of another kernel is a real call (`noinline`), as the
firmware's C would have it. Lengths follow their pointers in the parameter list.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from llvmlite import ir

from bfsim.kernel import divisions, floats, tree
from bfsim.kernel.floats import register_type
from bfsim.kernel.function import Function
from bfsim.kernel.intrinsics.meaning import function_type
from bfsim.kernel.ir_text import ENTERS, NO_HINT
from bfsim.kernel.types import ArrayType, FloatType, IntType, Number, u32

InlinedCall = tuple[str, str, int]
"""Symbols of caller and callee, and the line in the caller."""
Sites = tuple[tree.Load | tree.Store | tree.Binary, ...]
I1, I32, POINTER = ir.IntType(1), ir.IntType(32), ir.PointerType()
SIMPLE = {"+": "add", "-": "sub", "*": "mul", "&": "and_", "|": "or_", "^": "xor"}
# [predict.def of GCC 12] hit rates 67 % (continue) and 66 % (early return); both sides even otherwise
CONTINUES, RETURNS, GOES_ON = 33, 34, 67
EVEN = (GOES_ON, GOES_ON)
WORD_BITS = 32
SHIFT_MASK = 31  # a shift count uses its low five bits; the language refuses constants outside 0..31
MOST_SITES = (1 << 16) - 1  # LLVM keeps 16 bits of a column


def emit(function: Function, inlined: frozenset[InlinedCall] = frozenset()) -> ir.Module:
    """Emit `function` and every kernel it calls as one module; calls that are to be inlined are marked so."""
    return _emitted(function, inlined)[0]


def sites_of(function: Function) -> dict[str, Sites]:
    """Return, by symbol, the accesses and divisions of `function` and of every kernel it calls, in the order of their numbers.

    A number, from 1 on, is the column in the debug location of the instruction; what is none of them has column 0.
    """
    return _emitted(function, frozenset())[1]


def emit_alone(function: Function) -> ir.Module:
    """Emit `function` only; the kernels that it calls are declared."""
    module = _module(function)
    _Emitter(module, function, frozenset()).run()
    return module


def _emitted(function: Function, inlined: frozenset[InlinedCall]) -> tuple[ir.Module, dict[str, Sites]]:
    module = _module(function)
    sites = {}
    for each in (*function.callees(), function):
        emitter = _Emitter(module, each, inlined)
        emitter.run()
        sites[each.symbol] = tuple(emitter.sites)
    return module, sites


def _module(function: Function) -> ir.Module:
    """Make a module in which `function` and every kernel it calls is declared."""
    module = ir.Module(name=function.symbol)
    module.add_named_metadata(
        "llvm.module.flags", module.add_metadata([I32(2), "Debug Info Version", I32(3)])
    )
    for each in (*function.callees(), function):
        _declare(module, each)
    return module


def _weight(body: tuple[tree.Stmt, ...]) -> int:
    """Percent by which a side of an `if` is likely, as GCC guesses it from how the side ends."""
    last = body[-1] if body else None
    return (
        CONTINUES
        if isinstance(last, tree.Continue)
        else RETURNS
        if isinstance(last, tree.Return)
        else GOES_ON
    )


def _declare(module: ir.Module, function: Function) -> None:
    types: list[ir.Type] = []
    for parameter in function.parameters:
        if isinstance(parameter.type, ArrayType):
            types.extend([POINTER, I32])
        else:
            types.append(register_type(parameter.type))
    result = register_type(function.result) if function.result else ir.VoidType()
    declared = ir.Function(module, ir.FunctionType(result, types), function.symbol)
    declared.attributes.add("noinline")
    declared.attributes.add("nounwind")


@dataclass(slots=True)
class _Emitter:
    module: ir.Module
    function: Function
    inlined: frozenset[InlinedCall]
    sites: list[tree.Load | tree.Store | tree.Binary] = field(init=False, default_factory=list)
    """Accesses and divisions: what can go wrong in a run."""
    builder: ir.IRBuilder = field(init=False)
    line: int = field(init=False, default=1)
    scope: ir.values.MDValue = field(init=False)
    slots: dict[str, ir.Value] = field(init=False, default_factory=dict)
    arrays: dict[str, tuple[ir.Value, ir.Value]] = field(init=False, default_factory=dict)
    loops: list[tuple[ir.BasicBlock, ir.BasicBlock]] = field(init=False, default_factory=list)
    """Of each open loop: where `continue` and where `break` go."""
    weights: tuple[int, int] = field(init=False, default=EVEN)
    """How likely the `if` whose condition is being emitted is true, and false."""

    def run(self) -> None:
        target = self.module.get_global(self.function.symbol)
        self.scope = self._debug_scope(target)
        scalars = self._name_arguments(target)
        self.builder = ir.IRBuilder(target.append_basic_block("entry"))
        self._at(1)
        for number, (name, kind) in enumerate(self.function.locals):
            # the number outlives all passes: in which order variables are declared matters to a compiler
            self.slots[name] = self.builder.alloca(register_type(kind), name=f"{name}.v{number}")
        for name, value in scalars.items():
            self.builder.store(value, self.slots[name])
        self._block(self.function.body)
        if not self.builder.block.is_terminated:
            if self.function.result:
                self.builder.unreachable()
            else:
                self.builder.ret_void()

    def _name_arguments(self, target: ir.Function) -> dict[str, ir.Value]:
        """Name the arguments as the parameters, before anything else takes a name. Returns the scalars."""
        scalars: dict[str, ir.Value] = {}
        arguments = iter(target.args)
        for parameter in self.function.parameters:
            value = next(arguments)
            value.name = parameter.name
            if isinstance(parameter.type, ArrayType):
                length = next(arguments)
                length.name = f"{parameter.name}.len"
                self.arrays[parameter.name] = (value, length)
            else:
                scalars[parameter.name] = value
        return scalars

    def _debug_scope(self, target: ir.Function) -> ir.values.MDValue:
        file = self.module.add_debug_info("DIFile", {"filename": self.function.name, "directory": ""})
        unit = self.module.add_debug_info(
            "DICompileUnit",
            {"language": ir.DIToken("DW_LANG_C99"), "file": file, "isOptimized": True, "emissionKind": 2},
            is_distinct=True,
        )
        self.module.add_named_metadata("llvm.dbg.cu", unit)
        kind = self.module.add_debug_info("DISubroutineType", {"types": self.module.add_metadata([])})
        scope = self.module.add_debug_info(
            "DISubprogram",
            {"name": self.function.symbol, "file": file, "line": 1, "type": kind, "unit": unit, "spFlags": 8},
            is_distinct=True,
        )
        target.set_metadata("dbg", scope)
        return scope

    def _at(self, line: int, site: int = 0) -> None:
        self.line = line
        self.builder.debug_metadata = self.module.add_debug_info(
            "DILocation", {"line": line, "column": site if site <= MOST_SITES else 0, "scope": self.scope}
        )

    @contextmanager
    def _site(self, node: tree.Load | tree.Store | tree.Binary) -> Iterator[None]:
        """Number what is emitted inside as `node`."""
        self.sites.append(node)
        self._at(self.line, len(self.sites))
        yield
        self._at(self.line)

    # Statements

    def _block(self, body: tuple[tree.Stmt, ...]) -> None:
        for each in body:
            self._at(each.line)
            getattr(self, f"_{type(each).__name__.lower()}")(each)

    def _assign(self, node: tree.Assign) -> None:
        value = self.value(node.value)
        self.builder.store(value, self.slots[node.name])

    def _store(self, node: tree.Store) -> None:
        value = self.value(node.value)
        address = self._address(node.array, node.element, node.index)
        if node.element.bits < WORD_BITS:
            value = self.builder.trunc(value, ir.IntType(node.element.bits))
        with self._site(node):
            self.builder.store(value, address)

    def _evaluate(self, node: tree.Evaluate) -> None:
        self.value(node.call)

    def _return(self, node: tree.Return) -> None:
        if node.value is None:
            self.builder.ret_void()
        else:
            self.builder.ret(self.value(node.value))

    def _break(self, node: tree.Break) -> None:
        self.builder.branch(self.loops[-1][1])

    def _continue(self, node: tree.Continue) -> None:
        self.builder.branch(self.loops[-1][0])

    def _if(self, node: tree.If) -> None:
        yes, no, after = (self.builder.append_basic_block(name) for name in ("then", "else", "after"))
        self.weights = (_weight(node.body), _weight(node.orelse))
        self._hint(self.builder.cbranch(self.value(node.test), yes, no))
        self.weights = EVEN
        for block, body in ((yes, node.body), (no, node.orelse)):
            self.builder.position_at_end(block)
            self._block(body)
            self._fall_to(after)
        self.builder.position_at_end(after)

    def _hint(self, branch: ir.Instruction) -> None:
        if self.weights[0] != self.weights[1]:
            branch.set_weights(self.weights)

    def _while(self, node: tree.While) -> None:
        test, body, after = (self.builder.append_basic_block(name) for name in ("test", "body", "after"))
        self.builder.branch(test)
        self.builder.position_at_end(test)
        self._at(node.line)
        self.builder.cbranch(self.value(node.test), body, after)
        self.builder.position_at_end(body)
        with self._loop(test, after):
            self._block(node.body)
        self._fall_to(test)
        self.builder.position_at_end(after)

    def _for(self, node: tree.For) -> None:
        """The counter is hidden: what the body assigns to the loop's name does not change the iterations, as in Python."""
        builder = self.builder
        start, stop = self.value(node.start), self.value(node.stop)
        counter = self._entry_slot(I32, f"{node.name}.iteration")
        builder.store(start, counter)
        test, body, step, after = (
            builder.append_basic_block(name) for name in ("for", "body", "step", "after")
        )
        builder.branch(test)
        builder.position_at_end(test)
        now = builder.load(counter, typ=I32)
        builder.cbranch(builder.icmp_signed("<" if node.step > 0 else ">", now, stop), body, after)
        builder.position_at_end(body)
        builder.store(now, self.slots[node.name])
        with self._loop(step, after):
            self._block(node.body)
        self._at(node.line)
        self._fall_to(step)
        builder.position_at_end(step)
        # nsw: the counter cannot wrap before it passes `stop`, unless a step larger than 1 ends beyond 2**31
        builder.store(builder.add(builder.load(counter, typ=I32), I32(node.step), flags=["nsw"]), counter)
        builder.branch(test)
        builder.position_at_end(after)

    @contextmanager
    def _loop(self, again: ir.BasicBlock, after: ir.BasicBlock) -> Iterator[None]:
        self.loops.append((again, after))
        yield
        self.loops.pop()

    def _entry_slot(self, kind: ir.Type, name: str = "") -> ir.Value:
        """Return a slot at the head of the first block: behind a call that is inlined, LLVM would leave it in memory."""
        entry = self.builder.function.entry_basic_block
        before = next((each for each in entry.instructions if each.opname != "alloca"), None)
        with self.builder.goto_block(entry):
            if before is not None:
                self.builder.position_before(before)
            return self.builder.alloca(kind, name=name)

    def _fall_to(self, block: ir.BasicBlock) -> None:
        if not self.builder.block.is_terminated:
            self.builder.branch(block)

    # Expressions

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

    def _address(self, array: str, element: Number, index: tree.Expr) -> ir.Value:
        pointer, _ = self.arrays[array]
        return self.builder.gep(pointer, [self.value(index)], source_etype=ir.IntType(element.bits))

    def _load(self, node: tree.Load) -> ir.Value:
        address = self._address(node.array, node.element, node.index)
        is_float = isinstance(node.element, FloatType)
        with self._site(node):
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
            return self.builder.neg(value)
        if node.op == "~":
            return self.builder.not_(value)
        return self._intrinsic("llvm.abs.i32", [I32, I1], [value, I1(0)])

    def _float_intrinsic(self, name: str, result: ir.Type, arguments: list[ir.Value]) -> ir.Value:
        kind = ir.FunctionType(result, [each.type for each in arguments])
        return self.builder.call(
            self.module.globals.get(name) or ir.Function(self.module, kind, name), arguments
        )

    def _intrinsic(self, name: str, types: list[ir.Type], arguments: list[ir.Value]) -> ir.Value:
        target = self.module.globals.get(name) or ir.Function(self.module, ir.FunctionType(I32, types), name)
        return self.builder.call(target, arguments)

    def _binary(self, node: tree.Binary) -> ir.Value:
        left, right = self.value(node.left), self.value(node.right)
        if isinstance(node.type, FloatType):
            return floats.binary(self.builder, node.op, left, right)
        unsigned = node.type is u32
        if node.op in SIMPLE:
            return getattr(self.builder, SIMPLE[node.op])(left, right)
        if node.op in ("<<", ">>"):
            return self._shift(node, left, right)
        if node.op in ("min", "max"):
            return self._intrinsic(f"llvm.{'u' if unsigned else 's'}{node.op}.i32", [I32, I32], [left, right])
        with self._site(node):
            if unsigned:
                return divisions.unsigned(self.builder, node.op, left, right)
            constant = int(node.right.value) if isinstance(node.right, tree.Const) else None
            return divisions.signed(self.builder, node.op, left, right, constant)

    def _shift(self, node: tree.Binary, left: ir.Value, right: ir.Value) -> ir.Value:
        if not isinstance(node.right, tree.Const):
            right = self.builder.and_(right, I32(SHIFT_MASK))
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
        """The right side runs only when the left one does not decide."""
        slot = self._decided(node.left)
        more, after = (self.builder.append_basic_block(name) for name in (node.op, "decided"))
        left = self.builder.load(slot, typ=I1)
        branch = self.builder.cbranch(left, *((more, after) if node.op == "and" else (after, more)))
        if self._decides_alone(node.op):
            self._hint(branch)
        else:
            branch.set_weights(NO_HINT if node.op == "and" else NO_HINT[::-1])
        self.builder.position_at_end(more)
        self.builder.store(self.value(node.right), slot)
        self.builder.branch(after)
        self.builder.position_at_end(after)
        return self.builder.load(slot, typ=I1)

    def _decides_alone(self, op: str) -> bool:
        """Whether the left side of `and` or `or` may lead to a `continue` by itself: else the hint is the right one's.

        [predict_paths_leading_to in predict.cc of GCC 12.] The hint of a `return` stays with both sides.
        """
        yes, no = self.weights
        return min(yes, no) != CONTINUES or yes == no or (yes < no) == (op == "or")

    def _decided(self, node: tree.Expr) -> ir.Value:
        value = self.value(node)
        slot = self._entry_slot(I1)
        self.builder.store(value, slot)
        return slot

    def _not(self, node: tree.Not) -> ir.Value:
        return self.builder.not_(self.value(node.operand))

    def _choose(self, node: tree.Choose) -> ir.Value:
        """Only the chosen side runs, as in Python."""
        slot = self._entry_slot(register_type(node.type), "chosen")
        yes, no, after = (self.builder.append_basic_block(name) for name in ("yes", "no", "chosen"))
        self.builder.cbranch(self.value(node.test), yes, no)
        for block, side in ((yes, node.yes), (no, node.no)):
            self.builder.position_at_end(block)
            self.builder.store(self.value(side), slot)
            self.builder.branch(after)
        self.builder.position_at_end(after)
        return self.builder.load(slot, typ=register_type(node.type))

    def _intrinsiccall(self, node: tree.IntrinsicCall) -> ir.Value:
        """A call of a function without a body, until the code is compiled for the host: to LLVM, one that only computes."""
        intrinsic = node.intrinsic
        target = self.module.globals.get(intrinsic.symbol)
        if target is None:
            target = ir.Function(self.module, function_type(intrinsic), intrinsic.symbol)
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
            self.module.get_global(node.callee.symbol), arguments, attrs=self._entered(node)
        )
        return result

    def _entered(self, node: tree.KernelCall) -> tuple[str, ...]:
        """Say where the code of a kernel begins that is to be inlined; return what LLVM is to be told of its call."""
        callee = node.callee.symbol
        if (self.function.symbol, callee, node.line) not in self.inlined:
            return ()
        name = f"{ENTERS}{callee}"
        mark = self.module.globals.get(name)
        if mark is None:
            mark = ir.Function(self.module, ir.FunctionType(ir.VoidType(), []), name)
            # it stays in its block, and stands in nothing's way
            mark.attributes.add("inaccessiblememonly")
            mark.attributes.add("nounwind")
        self.builder.call(mark, [])
        return ("alwaysinline",)
