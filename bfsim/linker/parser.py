"""Reads an LDF: preprocessor, then the grammar in ldf.lark, then `builder`. Errors carry a caret."""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from bfsim.errors import LinkError
from bfsim.linker.preprocessor import preprocess
from bfsim.linker.script import LinkerScript
from bfsim.linker.source import Source

if TYPE_CHECKING:
    from lark import Lark, UnexpectedInput

# What would change a placement and is not modelled, with the reason that the error gives.
REFUSED = {
    "OVERLAY_INPUT": "overlays share an address at different times, and bfsim places each symbol once",
    "OVERLAY_GROUP": "overlays share an address at different times, and bfsim places each symbol once",
    "PLIT": "it belongs to overlays, and bfsim places each symbol once",
    "PACKING": "a Blackfin's memories are byte-wide, so there is nothing to pack",
    "FILL": "gaps have no contents in bfsim",
    "MPMEMORY": "the two cores of a BF561 share memory through COMMON_MEMORY",
    "INCLUDE": "bfsim reads one file",
}
_REFUSED_WORD = re.compile(rf"\b({'|'.join(REFUSED)})\s*[({{]")

# How an error names what it expected, where the pattern of a terminal would not help.
_READABLE = {
    "BOUND": "START, END, LENGTH or WIDTH",
    "CHIP": "the name of a chip",
    "FILE": "an object file",
    "_INIT": "NO_INIT or ZERO_INIT",
    "_KIND": "RAM or ROM",
    "LIST": "an object list such as $OBJECTS",
    "MEMORY_FUNCTION": "MEMORY_START, MEMORY_END or MEMORY_SIZEOF",
    "NAME": "a name",
    "_NAME": "a name",
    "_NO_EFFECT": "OUTPUT, KEEP or the like",
    "NUMBER": "a number",
    "STRING": "a quoted name",
    "_STRING": "a quoted name",
    "_TEXT": "text",
    "_VALUE": "a value",
    "$END": "the end of the file",
}


def parse_ldf(path: Path) -> LinkerScript:
    """Read the LDF at `path`; raise LinkError with file, line, column, the source line and a caret."""
    from lark import UnexpectedInput  # lark costs 50 ms, which --help and the like need not pay
    from lark.exceptions import VisitError

    from bfsim.linker.builder import ScriptBuilder

    source = preprocess(path)
    if refused := _REFUSED_WORD.search(source.expanded):
        word = refused[1]
        raise source.error_at(refused.start(), f"LDF must do without {word}: {REFUSED[word]}")
    try:
        return ScriptBuilder(source).transform(_grammar().parse(source.expanded))
    except UnexpectedInput as error:
        raise _syntax_error(source, error) from None
    except VisitError as error:
        if isinstance(error.orig_exc, LinkError):
            raise error.orig_exc from None
        raise


@cache
def _grammar() -> Lark:
    from lark import Lark

    text = files("bfsim.linker").joinpath("ldf.lark").read_text(encoding="utf-8")
    return Lark(text, parser="lalr", lexer="contextual")


def _syntax_error(source: Source, error: UnexpectedInput) -> LinkError:
    """Say what was expected instead of what was found, and where."""
    from lark import UnexpectedToken

    offset = error.pos_in_stream or 0
    if not isinstance(error, UnexpectedToken):
        expected, found = getattr(error, "allowed", None) or set(), repr(source.expanded[offset])
    elif error.token.type == "$END":
        expected, found = error.accepts or error.expected, "the end of the file"
        offset = len(source.expanded.rstrip())
    else:
        expected, found = error.accepts or error.expected, repr("".join(error.token.split()[:1])[:30])
    names = sorted({_readable(terminal) for terminal in expected})
    wanted = ", ".join(names[:-1]) + " or " * (len(names) > 1) + "".join(names[-1:])
    return source.error_at(offset, f"expected {wanted or 'an LDF command'}, not {found}")


def _readable(terminal: str) -> str:
    from lark.lexer import PatternStr

    if terminal in _READABLE:
        return _READABLE[terminal]
    pattern = _grammar().get_terminal(terminal).pattern
    return f"'{pattern.value}'" if isinstance(pattern, PatternStr) else terminal
