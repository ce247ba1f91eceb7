"""The typed tree of a kernel: what `language` makes of the Python source and `emit` turns into LLVM IR.

Every node carries `line`, counted from the first line of the kernel's source (its decorator) = 1.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property

from bfsim.kernel.intrinsics import Intrinsic
from bfsim.kernel.types import ArrayType, FloatType, IntType, Number, Value


@dataclass(frozen=True, slots=True)
class Const:
    """A number. `written`: how the source has it, where that says more (`MASK`, `2 * WIDTH`, `0xFF`) and C reads it alike."""

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
    """`for name in range(start, stop, step)`; step is a constant other than 0."""

    name: str
    start: Expr
    stop: Expr
    step: int
    body: tuple[Stmt, ...]
    line: int


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
class Parameter:
    name: str
    type: Number | ArrayType


@dataclass(frozen=True, slots=True)
class Body:
    """What a kernel does. `locals` gives the type of every local name."""

    locals: tuple[tuple[str, Value], ...]
    block: tuple[Stmt, ...]


@dataclass(frozen=True, eq=False)
class Function:
    """A whole kernel. `symbol` is its name in the machine code.

    `file`, `first_line` and `source` say where it stands, `names` what the names of its file mean.
    A kernel `is_static`, as C calls it, if other kernels of its file name it and nothing else there does: the file's main loops
    do not run it. Whether another file imports it is not looked at.
    `calls`: the kernels that it calls itself, each once, in source order. `written`: array parameters that it, or a kernel called
    by it, stores into. `digest`: of all that its code depends on but its callees. `read`: reads its body, which few runs need.
    """

    name: str
    symbol: str
    file: str
    first_line: int
    source: str
    names: Mapping[str, object]
    is_static: bool
    parameters: tuple[Parameter, ...]
    result: Number | None
    calls: tuple[Function, ...]
    written: frozenset[str]
    digest: str
    read: Callable[[], Body]

    def __repr__(self) -> str:
        """Return the symbol alone, which stands for it in the text of a call."""
        return self.symbol

    @cached_property
    def _body(self) -> Body:
        return self.read()

    @property
    def locals(self) -> tuple[tuple[str, Value], ...]:
        """Every local name with its type."""
        return self._body.locals

    @property
    def body(self) -> tuple[Stmt, ...]:
        """Its statements."""
        return self._body.block

    @property
    def array_names(self) -> tuple[str, ...]:
        """Names of the parameters that are arrays."""
        return tuple(each.name for each in self.parameters if isinstance(each.type, ArrayType))

    def first_float(self) -> int | None:
        """Line of the first float in the kernel itself, counted like every `line`; None without floats."""
        kinds = (Const, Local, Load, Binary, Unary, Choose, Cast, KernelCall)
        lines = [
            each.line
            for each in parts(self.body)
            if isinstance(each, kinds) and isinstance(each.type, FloatType)
        ]
        in_head = any(
            FloatType in (type(p.type), type(getattr(p.type, "element", None))) for p in self.parameters
        )
        return 1 if in_head else min(lines, default=None)

    def siblings(self) -> tuple[Function, ...]:
        """The other kernels of its file."""
        found = [getattr(each, "function", None) for each in self.names.values()]
        return tuple(
            each
            for each in found
            if isinstance(each, Function) and each.file == self.file and each is not self
        )

    def callees(self) -> tuple[Function, ...]:
        """Kernels that this one calls, directly or not, each once, callees first."""
        return _callees(self)


@cache
def _callees(function: Function) -> tuple[Function, ...]:
    found: dict[Function, None] = {}
    for each in function.calls:
        found.update(dict.fromkeys((*each.callees(), each)))
    return tuple(found)


def calls_in(node: object) -> list[KernelCall]:
    """Every call of a kernel in `node`, a part of a tree; the outer one of `f(g(x))` first."""
    return [each for each in parts(node) if isinstance(each, KernelCall)]


@cache
def measured_arrays(function: Function) -> frozenset[str]:
    """Array parameters whose length `function` or a kernel called by it asks for: in C, they come with it."""
    nodes = list(parts(function.body))
    found = {each.array for each in nodes if isinstance(each, Length)}
    for call in nodes:
        if isinstance(call, KernelCall):
            inner = measured_arrays(call.callee)
            pairs = zip(call.callee.parameters, call.arguments, strict=True)
            found |= {each for parameter, each in pairs if isinstance(each, str) and parameter.name in inner}
    return frozenset(found)


def written_arrays(body: Body) -> frozenset[str]:
    """Array parameters that a body, or a kernel called by it, stores into."""
    nodes = list(parts(body.block))
    written = {each.array for each in nodes if isinstance(each, Store)}
    for call in nodes:
        if isinstance(call, KernelCall):
            pairs = zip(call.callee.parameters, call.arguments, strict=True)
            written |= {
                each
                for parameter, each in pairs
                if isinstance(each, str) and parameter.name in call.callee.written
            }
    return frozenset(written)


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
