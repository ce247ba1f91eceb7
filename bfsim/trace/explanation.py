"""A kernel line by line, as one compiler profile sees it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplainedOperation:
    """An operation of a source line: `count` of them, `cclk` issue cycles each; `conditional`: one way of a branch."""

    operation: str
    mnemonic: str
    count: int
    cclk: int
    conditional: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplainedLine:
    """The part of one source line that stands in `depth` loops, and its cycles per execution, interlocks included.

    `stall_cclk` are the interlocks alone. `executions` and `total_cclk` are those of a run, at all depths together, and
    stand in the line's last row; None without a run.
    """

    line: int
    text: str
    depth: int
    operations: tuple[ExplainedOperation, ...]
    least_cclk: int
    most_cclk: int
    stall_cclk: int
    executions: int | None
    total_cclk: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplainedCall:
    """Calls of `callee` in one line: whether its code takes their place, and why or why not.

    `growth` is by how many statements, as the compiler counts them, the caller's code grows or would grow for each.
    """

    caller: str
    file: str
    line: int
    callee: str
    inlined: bool
    why: str
    growth: int


@dataclass(frozen=True, slots=True, kw_only=True)
class InlinedKernel:
    """A kernel whose code stands in that of another one: its lines there, at all its calls together."""

    kernel: str
    file: str
    lines: tuple[ExplainedLine, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Explanation:
    """One kernel as one compiler profile sees it. `calls` are those of a run, None without one.

    `lines` are its own; `kernel_calls` says what became of its calls of other kernels.
    """

    kernel: str
    file: str
    first_line: int
    profile: str
    code_bytes: int
    calls: int | None
    lines: tuple[ExplainedLine, ...]
    kernel_calls: tuple[ExplainedCall, ...]
    inlined: tuple[InlinedKernel, ...]
