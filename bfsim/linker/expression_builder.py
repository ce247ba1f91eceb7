"""Builds expressions from the parse tree of an LDF; what is constant is computed as it is read."""

from __future__ import annotations

from typing import TypeVar

from lark import Token, v_args
from lark.visitors import Transformer_NonRecursive

from bfsim.errors import cut
from bfsim.linker.expressions import NO_SCOPE, WIDEST_BITS, Expression, ExpressionError

Start = TypeVar("Start")  # what the start rule becomes

_SUFFIXES = {"K": 1024, "M": 1024 * 1024}
_DEEPEST = 100  # expressions with symbols; constants may be deeper

_BINDING = {
    sign: binding
    for binding, signs in enumerate(
        (
            ("||",),
            ("&&",),
            ("|",),
            ("^",),
            ("&",),
            ("==", "!="),
            ("<", ">", "<=", ">="),
            ("<<", ">>"),
            ("+", "-"),
            ("*", "/", "%"),
        )
    )
    for sign in signs
}


@v_args(inline=True)
class ExpressionBuilder(Transformer_NonRecursive[Token, Start]):
    """One method per rule for expressions in ldf.lark."""

    def number(self, text: Token) -> Expression:
        offset = text.start_pos or 0
        try:
            value = _value_of(text.rstrip("uUlL"))
        except ValueError:  # Python reads no decimal number of more than 4,300 digits
            value = None
        if value is None or value.bit_length() > WIDEST_BITS:
            raise ExpressionError(offset, f"number must fit in {WIDEST_BITS} bits, not {cut(text)}")
        return Expression(offset, "number", number=value)

    def name(self, name: Token) -> Expression:
        return Expression(name.start_pos or 0, "name", text=str(name))

    def call(self, function: Token, argument: Expression) -> Expression:
        return _combine(function, "call", (argument,), str(function))

    def signed(self, sign: Token, operand: Expression) -> Expression:
        return _combine(sign, str(sign), (operand,))

    def expr(self, first: Expression, *rest: Expression | Token | None) -> Expression:
        """Give each operator its operands: `rest` alternates the two, and ends with the two branches of "?" or None."""
        *pairs, then, otherwise = rest
        operands, signs = [first], list[Token]()
        for sign, operand in zip(pairs[::2], pairs[1::2], strict=True):
            assert isinstance(sign, Token)
            assert isinstance(operand, Expression)
            while signs and _BINDING[signs[-1]] >= _BINDING[sign]:
                _reduce(operands, signs)
            signs.append(sign)
            operands.append(operand)
        while signs:
            _reduce(operands, signs)
        if isinstance(then, Expression) and isinstance(otherwise, Expression):
            return _choose(operands[0], then, otherwise)
        return operands[0]

    def condition(self, expression: Expression) -> Expression:
        return expression


def _value_of(digits: str) -> int:
    if digits[:2] in ("0x", "0X"):
        return int(digits, 16)
    if "#" in digits:
        return int(digits.partition("#")[2], 2)
    return int(digits.rstrip("kKmM")) * _SUFFIXES.get(digits[-1].upper(), 1)


def _reduce(operands: list[Expression], signs: list[Token]) -> None:
    """Replace the last two operands by their combination."""
    sign, right, left = signs.pop(), operands.pop(), operands.pop()
    operands.append(_combine(sign, str(sign), (left, right)))


def _choose(condition: Expression, then: Expression, otherwise: Expression) -> Expression:
    if condition.is_number:
        return then if condition.number else otherwise
    operands = (condition, then, otherwise)
    return Expression(condition.offset, "?", operands, depth=_depth(*operands))


def _combine(token: Token, sign: str, operands: tuple[Expression, ...], text: str = "") -> Expression:
    """Make an expression; compute it if all its operands are numbers and it has a value."""
    expression = Expression(token.start_pos or 0, sign, operands, text, depth=_depth(*operands))
    if expression.depth > _DEEPEST:
        raise ExpressionError(expression.offset, f"expression must nest at most {_DEEPEST} deep")
    if sign == "call" or not all(operand.is_number for operand in operands):
        return expression
    try:
        return Expression(expression.offset, "number", number=expression.value_in(NO_SCOPE))
    except ExpressionError:
        return expression  # it may stand in a branch that is never taken


def _depth(*operands: Expression) -> int:
    return 1 + max(operand.depth for operand in operands)
