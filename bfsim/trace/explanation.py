"""A kernel line by line, as seen by one compiler profile."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplainedOperation:
    """An operation of a source line: `count` of them, `cclk` issue cycles each. `conditional` if on one side of a branch."""

    operation: str
    mnemonic: str
    count: int
    cclk: int
    conditional: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplainedLine:
    """The part of one source line that is in `depth` loops, and its cycles per execution, including interlocks.

    `stall_cclk` are the interlocks alone. `executions` and `total_cclk` come from a run, for all depths together, and
    are in the line's last row. They are None without a run.
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
    """Calls of `callee` in one line: whether they are inlined, and why or why not.

    `growth` is the number of statements, as the compiler counts them, by which each call grows or would grow the caller.
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
    """A kernel whose code is inlined in another one: its lines there, for all its calls together."""

    kernel: str
    file: str
    lines: tuple[ExplainedLine, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Explanation:
    """One kernel as seen by one compiler profile. `calls` are from a run, None without one.

    `lines` are its own. `kernel_calls` says what became of its calls of other kernels.
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
