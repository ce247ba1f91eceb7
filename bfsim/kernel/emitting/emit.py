"""Typed tree → LLVM IR, unoptimised: every local in a stack slot, one debug line per statement.

An array is a plain pointer and its length, which follows it in the parameter list. A call of another kernel is a real
call (`noinline`), as in firmware written in C.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from llvmlite import ir

from bfsim.kernel.emitting.floats import register_type
from bfsim.kernel.emitting.subloops import end_of_subloop, makes_subloop
from bfsim.kernel.emitting.values import (
    CONTINUES,
    EVEN,
    GOES_ON,
    I32,
    RETURNS,
    WORD_BITS,
    InlinedCall,
    Site,
    Values,
)
from bfsim.kernel.ir.text import LEAVES, OF_VARIABLE
from bfsim.kernel.language import tree
from bfsim.kernel.language.function import Function
from bfsim.kernel.types import ArrayType

Sites = tuple[Site, ...]
POINTER = ir.PointerType()


def emit(
    function: Function, inlined: frozenset[InlinedCall] = frozenset(), *, one_way_back: bool = True
) -> ir.Module:
    """Emit `function` and every kernel it calls as one module; mark the calls that are to be inlined.

    `one_way_back`: whether all ways back to the test of a `while` join before it if GCC makes one loop of them
    (`subloops`).
    """
    return _emitted(function, inlined, one_way_back=one_way_back)[0]


def sites_of(function: Function) -> dict[str, Sites]:
    """Return the sites in `function` and in every kernel it calls, by symbol, in the order of their numbers.

    The number, from 1 on, is the column in the debug location of the site's instruction; other instructions have column
    0.
    """
    return _emitted(function, frozenset(), one_way_back=True)[1]


def emit_alone(function: Function) -> ir.Module:
    """Emit `function` only; the kernels that it calls are declared."""
    module = _module(function)
    _emit_into(module, function, frozenset(), one_way_back=True)
    return module


def _emitted(
    function: Function, inlined: frozenset[InlinedCall], *, one_way_back: bool
) -> tuple[ir.Module, dict[str, Sites]]:
    module = _module(function)
    all_of_them = (*function.callees(), function)
    return module, {
        each.symbol: _emit_into(module, each, inlined, one_way_back=one_way_back) for each in all_of_them
    }


def _module(function: Function) -> ir.Module:
    """Make a module in which `function` and every kernel it calls is declared."""
    module = ir.Module(name=function.symbol)
    module.add_named_metadata(
        "llvm.module.flags", module.add_metadata([I32(2), "Debug Info Version", I32(3)])
    )
    for each in (*function.callees(), function):
        _declare(module, each)
    return module


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


def _emit_into(
    module: ir.Module, function: Function, inlined: frozenset[InlinedCall], *, one_way_back: bool
) -> Sites:
    """Emit the code of a kernel that is declared; return its sites."""
    target = module.get_global(function.symbol)
    scope = _debug_scope(module, target, function)
    arrays, scalars = _name_arguments(target, function)
    builder = ir.IRBuilder(target.append_basic_block("entry"))
    values = Values(builder, function, inlined, scope, arrays)
    values.at(1)
    body = tree.body_of(function)
    for number, (name, kind) in enumerate(body.locals):
        # the number outlives all passes: the order of declarations matters to a compiler
        values.slots[name] = builder.alloca(register_type(kind), name=f"{name}.v{number}")
    for name, value in scalars.items():
        builder.store(value, values.slots[name])
    _Statements(builder, values, body.block, one_way_back).emit(body.block)
    if not builder.block.is_terminated:
        if function.result:
            builder.unreachable()
        else:
            builder.ret_void()
    return tuple(values.sites)


def _name_arguments(
    target: ir.Function, function: Function
) -> tuple[dict[str, tuple[ir.Value, ir.Value]], dict[str, ir.Value]]:
    """Name the arguments after the parameters, before anything else takes a name. Return the arrays and the scalars."""
    arrays: dict[str, tuple[ir.Value, ir.Value]] = {}
    scalars: dict[str, ir.Value] = {}
    arguments = iter(target.args)
    for parameter in function.parameters:
        value = next(arguments)
        value.name = parameter.name
        if isinstance(parameter.type, ArrayType):
            length = next(arguments)
            length.name = f"{parameter.name}.len"
            arrays[parameter.name] = (value, length)
        else:
            scalars[parameter.name] = value
    return arrays, scalars


def _debug_scope(module: ir.Module, target: ir.Function, function: Function) -> ir.values.MDValue:
    file = module.add_debug_info("DIFile", {"filename": function.name, "directory": ""})
    unit = module.add_debug_info(
        "DICompileUnit",
        {"language": ir.DIToken("DW_LANG_C99"), "file": file, "isOptimized": True, "emissionKind": 2},
        is_distinct=True,
    )
    module.add_named_metadata("llvm.dbg.cu", unit)
    kind = module.add_debug_info("DISubroutineType", {"types": module.add_metadata([])})
    scope = module.add_debug_info(
        "DISubprogram",
        {"name": function.symbol, "file": file, "line": 1, "type": kind, "unit": unit, "spFlags": 8},
        is_distinct=True,
    )
    target.set_metadata("dbg", scope)
    return scope


def _weight(body: tuple[tree.Stmt, ...]) -> int:
    """Return how likely a side of an `if` is, in percent, as GCC guesses from how the side ends."""
    last = body[-1] if body else None
    return (
        CONTINUES
        if isinstance(last, tree.Continue)
        else RETURNS
        if isinstance(last, tree.Return)
        else GOES_ON
    )


@dataclass(slots=True)
class _Statements:
    """Emits what a kernel does, statement by statement, at the place of `builder`."""

    builder: ir.IRBuilder
    values: Values
    body: tuple[tree.Stmt, ...]
    one_way_back: bool
    loops: list[tuple[ir.BasicBlock, ir.BasicBlock]] = field(init=False, default_factory=list)
    """For each open loop, where `continue` and `break` go."""
    leaving: dict[int, tuple[int, int]] = field(init=False, default_factory=dict)
    """Weights of the tests that leave a loop which begins with the same test as the loop around it, by `id`."""

    def emit(self, body: tuple[tree.Stmt, ...]) -> None:
        """Emit statements one after the other."""
        for each in body:
            self.values.at(each.line)
            getattr(self, f"_{type(each).__name__.lower()}")(each)

    def _assign(self, node: tree.Assign) -> None:
        value = self.values.value(node.value)
        self.builder.store(value, self.values.slots[node.name])

    def _store(self, node: tree.Store) -> None:
        value = self.values.value(node.value)
        address = self.values.address(node.array, node.element, node.index)
        if node.element.bits < WORD_BITS:
            name = OF_VARIABLE if isinstance(node.value, tree.Local) else ""
            value = self.builder.trunc(value, ir.IntType(node.element.bits), name=name)
        with self.values.site(node):
            self.builder.store(value, address)

    def _evaluate(self, node: tree.Evaluate) -> None:
        self.values.value(node.call)

    def _return(self, node: tree.Return) -> None:
        if node.value is None:
            self.builder.ret_void()
        else:
            self.builder.ret(self.values.value(node.value))

    def _break(self, node: tree.Break) -> None:
        self.builder.branch(self.loops[-1][1])

    def _continue(self, node: tree.Continue) -> None:
        self.builder.branch(self.loops[-1][0])

    def _if(self, node: tree.If) -> None:
        yes, no, after = (self.builder.append_basic_block(name) for name in ("then", "else", "after"))
        self.values.weights = self.leaving.get(id(node), (_weight(node.body), _weight(node.orelse)))
        self.values.hint(self.builder.cbranch(self.values.value(node.test), yes, no))
        self.values.weights = EVEN
        for block, body in ((yes, node.body), (no, node.orelse)):
            self.builder.position_at_end(block)
            self.emit(body)
            self._fall_to(after)
        self.builder.position_at_end(after)

    def _while(self, node: tree.While) -> None:
        test, body, after = (self.builder.append_basic_block(name) for name in ("test", "body", "after"))
        joins = self.one_way_back and not makes_subloop(node, self.body)
        again = self.builder.append_basic_block("again") if joins else test
        self.builder.branch(test)
        self.builder.position_at_end(test)
        self.values.at(node.line)
        if self.one_way_back and (end := end_of_subloop(node, self.body)) is not None:
            self.values.hold()
            self.leaving[id(end[0])] = LEAVES if end[1] else LEAVES[::-1]
        self.builder.cbranch(self.values.value(node.test), body, after)
        self.builder.position_at_end(body)
        with self._loop(again, after):
            self.emit(node.body)
        self._fall_to(again)
        if joins:
            self.builder.position_at_end(again)
            self.builder.branch(test)
        self.builder.position_at_end(after)

    def _for(self, node: tree.For) -> None:
        """Emit a loop with a hidden counter: as in Python, assigning to the loop's name does not change the iterations."""
        builder = self.builder
        start, stop = self.values.value(node.start), self.values.value(node.stop)
        counter = self.values.entry_slot(I32, f"{node.name}.iteration")
        builder.store(start, counter)
        if isinstance(node.step, tree.Local):
            self.values.steps(node, start, stop, self.values.value(node.step))
        test, body, step, after = (
            builder.append_basic_block(name) for name in ("for", "body", "step", "after")
        )
        builder.branch(test)
        builder.position_at_end(test)
        now = builder.load(counter, typ=I32)
        builder.cbranch(builder.icmp_signed("<" if node.goes_up else ">", now, stop), body, after)
        builder.position_at_end(body)
        builder.store(now, self.values.slots[node.name])
        with self._loop(step, after):
            self.emit(node.body)
        self.values.at(node.line)
        self._fall_to(step)
        builder.position_at_end(step)
        now = builder.load(counter, typ=I32)
        by = self.values.value(node.step) if isinstance(node.step, tree.Local) else I32(node.step)
        # nsw: the counter cannot wrap before it passes `stop`, unless a constant step larger than 1 ends beyond 2**31
        builder.store(builder.add(now, by, flags=["nsw"]), counter)
        builder.branch(test)
        builder.position_at_end(after)

    @contextmanager
    def _loop(self, again: ir.BasicBlock, after: ir.BasicBlock) -> Iterator[None]:
        self.loops.append((again, after))
        yield
        self.loops.pop()

    def _fall_to(self, block: ir.BasicBlock) -> None:
        if not self.builder.block.is_terminated:
            self.builder.branch(block)
