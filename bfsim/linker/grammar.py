"""The grammar in ldf.lark: trees of LDFs, values of conditions, and messages of syntax errors."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from lark import Lark, Token, Tree, UnexpectedInput, UnexpectedToken
from lark.exceptions import VisitError
from lark.lexer import PatternStr

from bfsim.errors import LinkError, printable
from bfsim.linker.expression_builder import ExpressionBuilder
from bfsim.linker.expressions import NO_SCOPE, Expression, ExpressionError
from bfsim.linker.source import Source

# How an error names what it expected, where the pattern of a terminal would not help.
_READABLE = {
    "_ASSEMBLY": "instructions",
    "BOUND": "START, END, LENGTH or WIDTH",
    "CHIP": "the name of a chip",
    "_COMMAND": "OUTPUT, KEEP or the like",
    "FILE": "an object file",
    "INPUT_SECTIONS": "INPUT_SECTIONS",
    "_KIND": "RAM or ROM",
    "LIST": "an object list such as $OBJECTS",
    "NAME": "a name",
    "_NAME": "a name",
    "NUMBER": "a number",
    "OBJECT": "an object file",
    "_OBJECT": "a file",
    "OPERATOR": "an operator",
    "_OVERLAY_COMMAND": "ALGORITHM or the like",
    "QMARK": "an operator",
    "_QUALIFIER": "NO_INIT or ZERO_INIT",
    "SECTION": "a section",
    "SIGN": "a sign",
    "STRING": "a quoted name",
    "_STRING": "a quoted name",
    "_TEXT": "text",
    "$END": "the end of the file",
}


def parse_tree(source: Source) -> Tree[Token]:
    """Parse a preprocessed LDF; raise LinkError with place, source line and caret."""
    try:
        return _grammar().parse(source.expanded, start="start")
    except UnexpectedInput as error:
        raise _syntax_error(source, error) from None


def parse_condition(text: str) -> int:
    """Return the value of a condition without macros; raise LinkError without a place if it has none."""
    try:
        tree = _grammar().parse(text, start="condition")
        return ExpressionBuilder[Expression]().transform(tree).value_in(NO_SCOPE)
    except UnexpectedInput as error:
        offset, wanted, found = _difference(text, error)
        raise LinkError(f"expected {wanted}, not {found} in column {offset + 1}") from None
    except ExpressionError as error:
        raise LinkError(error.problem) from None
    except VisitError as error:
        raise LinkError(str(error.orig_exc)) from None


@cache
def _grammar() -> Lark:
    """Return the parser. It takes 50 ms to make and is not kept: a kept one would be a pickle, which runs code when read."""
    text = files("bfsim.linker").joinpath("ldf.lark").read_text(encoding="utf-8")
    return Lark(text, parser="lalr", lexer="contextual", start=["start", "condition"])


def _syntax_error(source: Source, error: UnexpectedInput) -> LinkError:
    offset, wanted, found = _difference(source.expanded, error)
    return source.error_at(offset, f"expected {wanted or 'an LDF command'}, not {found}")


def _difference(text: str, error: UnexpectedInput) -> tuple[int, str, str]:
    """Return where a text leaves the grammar, what was expected there and what was found."""
    offset = error.pos_in_stream or 0
    if name := _unknown_command(error):
        return name.start_pos or 0, "a command that bfsim knows, or an assignment with '='", _quoted(name)
    if not isinstance(error, UnexpectedToken):
        expected, found = getattr(error, "allowed", None) or set(), _quoted(text[offset])
    elif error.token.type == "$END":
        expected, found = error.accepts or error.expected, "the end of the file"
        offset = len(text.rstrip())
    else:
        expected, found = error.accepts or error.expected, _quoted("".join(error.token.split()[:1]))
    names = sorted({_readable(terminal) for terminal in expected})
    return offset, ", ".join(names[:-1]) + " or " * (len(names) > 1) + "".join(names[-1:]), found


def _unknown_command(error: UnexpectedInput) -> Token | None:
    """Return the name before the error if only an assignment can follow it: a command, misspelt or of another linker."""
    if not (isinstance(error, UnexpectedToken) and error.interactive_parser and error.expected == {"EQUAL"}):
        return None
    last = error.interactive_parser.parser_state.value_stack[-1]
    return last if isinstance(last, Token) and last.type == "NAME" else None


def _quoted(text: str) -> str:
    return f"'{printable(text[:30])}'"


def _readable(terminal: str) -> str:
    if terminal in _READABLE:
        return _READABLE[terminal]
    pattern = _grammar().get_terminal(terminal).pattern
    return f"'{pattern.value}'" if isinstance(pattern, PatternStr) else terminal
