"""Expressions of an LDF: C's operators on integers, names and functions."""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

WIDEST_BITS = 64  # of an intermediate value; an address has 32


class ExpressionError(Exception):
    """Raised for an error in the expression at `offset`; the file is added where it is known."""

    def __init__(self, offset: int, problem: str) -> None:
        super().__init__(problem)
        self.offset = offset
        self.problem = problem


class Scope(Protocol):
    """What the names in an expression stand for."""

    def value_of(self, name: str, offset: int, /) -> int:
        """Return the value of a symbol, or of the location counter '.'."""
        ...

    def result_of(self, function: str, argument: Expression, offset: int, /) -> int:
        """Return the value of a function such as MEMORY_END(segment)."""
        ...


@dataclass(frozen=True, slots=True)
class Expression:
    """An expression whose text starts at `offset`: an `operator` with `operands`, a "name", "call" or "number".

    `text` is the name or function, `number` the value of a number.
    """

    offset: int
    operator: str
    operands: tuple[Expression, ...] = ()
    text: str = ""
    number: int = 0
    depth: int = 0

    @property
    def is_number(self) -> bool:
        """Whether the value is known without a scope."""
        return self.operator == "number"

    def value_in(self, scope: Scope) -> int:
        """Return the value; raise ExpressionError if it has none."""
        match self.operator:
            case "number":
                return self.number
            case "name":
                return scope.value_of(self.text, self.offset)
            case "call":
                return scope.result_of(self.text, self.operands[0], self.offset)
            case "&&" | "||" | "?":
                return self._value_of_branch(scope)
        return self._apply([operand.value_in(scope) for operand in self.operands])

    def _value_of_branch(self, scope: Scope) -> int:
        """Return the value of the operands that count: a branch that is not taken need not have one."""
        first, *rest = self.operands
        is_true = first.value_in(scope) != 0
        if self.operator == "?":
            return rest[not is_true].value_in(scope)
        if is_true == (self.operator == "||"):
            return int(is_true)
        return int(rest[0].value_in(scope) != 0)

    def _apply(self, values: list[int]) -> int:
        compute = _UNARY[self.operator] if len(values) == 1 else _BINARY[self.operator]
        if self.operator in ("/", "%") and values[1] == 0:
            raise ExpressionError(self.offset, "divisor must not be 0")
        if self.operator in ("<<", ">>") and not 0 <= values[1] < WIDEST_BITS:
            raise ExpressionError(self.offset, f"shift must be by 0 to {WIDEST_BITS - 1}, not {values[1]}")
        value = compute(*values)
        if value.bit_length() > WIDEST_BITS:
            raise ExpressionError(self.offset, f"value must fit in {WIDEST_BITS} bits")
        return value


def _divide(dividend: int, divisor: int) -> int:
    """Divide as C does: towards 0."""
    quotient = abs(dividend) // abs(divisor)
    return quotient if (dividend < 0) == (divisor < 0) else -quotient


_UNARY: dict[str, Callable[..., int]] = {
    "-": operator.neg,
    "+": operator.pos,
    "~": operator.invert,
    "!": lambda operand: int(operand == 0),
}
_BINARY: dict[str, Callable[..., int]] = {
    "*": operator.mul,
    "/": _divide,
    "%": lambda left, right: left - right * _divide(left, right),
    "+": operator.add,
    "-": operator.sub,
    "<<": operator.lshift,
    ">>": operator.rshift,
    "<": operator.lt,
    ">": operator.gt,
    "<=": operator.le,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "&": operator.and_,
    "^": operator.xor,
    "|": operator.or_,
}


class _NoScope:
    """The scope of a condition: no functions, and names that are not macros are 0."""

    def value_of(self, _name: str, _offset: int, /) -> int:
        """Return 0, as C does in #if."""
        return 0

    def result_of(self, function: str, _argument: Expression, offset: int, /) -> int:
        """Refuse a function."""
        raise ExpressionError(offset, f"function must not stand in a condition: {function}")


NO_SCOPE: Scope = _NoScope()
