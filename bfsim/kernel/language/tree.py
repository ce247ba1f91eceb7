"""The typed tree of a kernel: what `language` makes of the Python source and `emit` turns into LLVM IR.

Every node carries `line`, counted from the first line of the kernel's source (its decorator) = 1. What may fail in a run
also has its `column`, in bytes from 0 on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache

from bfsim.kernel.intrinsics import Intrinsic
from bfsim.kernel.language.function import Function
from bfsim.kernel.types import FloatType, IntType, Number, Value


@dataclass(frozen=True, slots=True)
class Const:
    """A number. `written`: as in the source, if that says more (`MASK`, `2 * WIDTH`, `0xFF`) and means the same in C."""

    value: int | float
    type: Number
    line: int
    written: str = field(default="", compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Local:
    name: str
    type: Value
    line: int


@dataclass(frozen=True, slots=True)
class Load:
    """`array[index]`, extended to 32 bits."""

    array: str
    element: Number
    index: Expr
    type: Number
    line: int
    column: int = field(default=0, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Length:
    array: str
    type: IntType
    line: int


@dataclass(frozen=True, slots=True)
class Binary:
    """Arithmetic: one of + - * / // % << >> & | ^ min max quotient remainder, both sides of one type."""

    op: str
    left: Expr
    right: Expr
    type: Number
    line: int
    column: int = field(default=0, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Unary:
    """One of - ~ abs sqrt."""

    op: str
    operand: Expr
    type: Number
    line: int


@dataclass(frozen=True, slots=True)
class Compare:
    op: str
    left: Expr
    right: Expr
    type: Value
    line: int


@dataclass(frozen=True, slots=True)
class Logic:
    """`and` / `or` with the short circuit of Python."""

    op: str
    left: Expr
    right: Expr
    type: Value
    line: int


@dataclass(frozen=True, slots=True)
class Not:
    operand: Expr
    type: Value
    line: int


@dataclass(frozen=True, slots=True)
class Choose:
    """`yes if test else no`."""

    test: Expr
    yes: Expr
    no: Expr
    type: Value
    line: int


@dataclass(frozen=True, slots=True)
class Cast:
    """Keep the low bits of `operand` as `to`, then extend to 32 bits; or convert to or from f32."""

    operand: Expr
    to: Number
    type: Number
    line: int


@dataclass(frozen=True, slots=True)
class KernelCall:
    """A call of another kernel; array arguments are names."""

    callee: Function
    arguments: tuple[Expr | str, ...]
    type: Number | None
    line: int


@dataclass(frozen=True, slots=True)
class IntrinsicCall:
    """An instruction of the Blackfin, or a few, as a function."""

    intrinsic: Intrinsic
    arguments: tuple[Expr, ...]
    type: Value
    line: int


@dataclass(frozen=True, slots=True)
class Word:
    """The upper or the lower word of a pair."""

    pair: Expr
    upper: bool
    type: IntType
    line: int


Expr = (
    Const | Local | Load | Length | Binary | Unary | Compare | Logic | Not | Choose | Cast | KernelCall
    | IntrinsicCall | Word
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Assign:
    name: str
    value: Expr
    line: int


@dataclass(frozen=True, slots=True)
class Store:
    array: str
    element: Number
    index: Expr
    value: Expr
    line: int
    column: int = field(default=0, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class If:
    test: Expr
    body: tuple[Stmt, ...]
    orelse: tuple[Stmt, ...]
    line: int


@dataclass(frozen=True, slots=True)
class While:
    test: Expr
    body: tuple[Stmt, ...]
    line: int


@dataclass(frozen=True, slots=True)
class For:
    """`for name in range(start, stop, step)`; step is a constant other than 0, or a local that the loop does not change."""

    name: str
    start: Expr
    stop: Expr
    step: int | Local
    body: tuple[Stmt, ...]
    line: int
    column: int = field(default=0, compare=False, repr=False)

    @property
    def goes_up(self) -> bool:
        """Whether the counter grows; a step that is not constant must be positive."""
        return isinstance(self.step, Local) or self.step > 0


@dataclass(frozen=True, slots=True)
class Return:
    value: Expr | None
    line: int


@dataclass(frozen=True, slots=True)
class Evaluate:
    """A call made for its effect."""

    call: KernelCall
    line: int


@dataclass(frozen=True, slots=True)
class Break:
    line: int


@dataclass(frozen=True, slots=True)
class Continue:
    line: int


Stmt = Assign | Store | If | While | For | Return | Evaluate | Break | Continue


@dataclass(frozen=True, slots=True)
class Body:
    """What a kernel does. `locals` gives the type of every local name."""

    locals: tuple[tuple[str, Value], ...]
    block: tuple[Stmt, ...]


@cache
def body_of(function: Function) -> Body:
    """Return the body of a kernel."""
    body = function.read()
    assert isinstance(body, Body)
    return body


def first_float(function: Function) -> int | None:
    """Return the line of the first float in a kernel itself, counted like every `line`; None without floats."""
    kinds = (Const, Local, Load, Binary, Unary, Choose, Cast, KernelCall)
    lines = [
        each.line
        for each in parts(body_of(function).block)
        if isinstance(each, kinds) and isinstance(each.type, FloatType)
    ]
    in_head = any(
        FloatType in (type(p.type), type(getattr(p.type, "element", None))) for p in function.parameters
    )
    return 1 if in_head else min(lines, default=None)


def calls_in(node: object) -> list[KernelCall]:
    """Return every call of a kernel in `node`, a part of a tree; the outer one of `f(g(x))` first."""
    return [each for each in parts(node) if isinstance(each, KernelCall)]


def reads_array(node: object) -> bool:
    """Whether `node`, a part of a tree, loads an element, or calls a kernel, which may do so."""
    return any(isinstance(each, (Load, KernelCall)) for each in parts(node))


def measured_arrays(body: Body) -> frozenset[str]:
    """Return the array parameters whose length a body, or a kernel called by it, asks for."""
    return _arrays(body, Length, lambda callee: callee.measured)


def written_arrays(body: Body) -> frozenset[str]:
    """Return the array parameters that a body, or a kernel called by it, stores into."""
    return _arrays(body, Store, lambda callee: callee.written)


def _arrays(
    body: Body, kind: type[Length | Store], of: Callable[[Function], frozenset[str]]
) -> frozenset[str]:
    """Return the arrays that a body has in a `kind` of node, or passes to a kernel as one `of` its parameters."""
    nodes = list(parts(body.block))
    found = {each.array for each in nodes if isinstance(each, kind)}
    for call in nodes:
        if isinstance(call, KernelCall):
            pairs = zip(call.callee.parameters, call.arguments, strict=True)
            found |= {
                each
                for parameter, each in pairs
                if isinstance(each, str) and parameter.name in of(call.callee)
            }
    return frozenset(found)


def parts(node: object) -> Iterator[object]:
    """Walk over `node` and everything below it, in source order, without recursion: trees may be deep."""
    waiting = [node]
    while waiting:
        node = waiting.pop()
        if isinstance(node, tuple):
            waiting.extend(reversed(node))
        elif hasattr(node, "line"):
            yield node
            waiting.extend(getattr(node, each) for each in reversed(node.__slots__))  # type: ignore[attr-defined]


def alike(one: Expr, other: Expr) -> bool:
    """Whether two expressions are written alike, wherever they stand."""
    return [*map(_said, parts(one))] == [*map(_said, parts(other))]


def _said(part: object) -> tuple[object, ...]:
    """Return what a part of an expression says besides its operands."""
    own = (getattr(part, each, None) for each in ("name", "array", "op", "to", "callee", "intrinsic"))
    return (type(part), *own, part.value if isinstance(part, Const) else None)
