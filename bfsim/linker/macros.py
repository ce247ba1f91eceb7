"""The macros of the LDF preprocessor: what #define says, and their expansion, as in C."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

TOKEN = re.compile(
    r"""(?P<directive> ^[ \t]*\#(?: \\\r?\n | /\*.*?\*/ | (?!//)[^\n] )* )
      | (?P<comment>   /\*.*?\*/ | //[^\n]* )
      | (?P<unclosed>  /\* )
      | (?P<string>    "[^"\n]*" )
      | (?P<defined>   \bdefined\s*\(?\s*\w+ )
      | (?P<word>      \$?\w+ )""",
    re.VERBOSE | re.MULTILINE | re.DOTALL,
)
_PIECE_OF_BODY = re.compile(r'\s*(?P<paste>\#\#)\s*|\#\s*(?P<quoted>\w+)|(?P<word>\w+)|"[^"\n]*"')
_OPENING = re.compile(r"\s*\(")
_PART_OF_ARGUMENTS = re.compile(r'"[^"\n]*"|[(),]')

# Bounds for macros that were written to explode; the default LDFs of VisualDSP++ stay below 3 and 1000.
_DEEPEST_NESTING = 50
_LONGEST_EXPANSION = 100_000

Macros = dict[str, "Macro"]


@dataclass(frozen=True, slots=True)
class Macro:
    """A #define: `parameters` is None for one without parentheses."""

    parameters: tuple[str, ...] | None
    body: str


class MacroError(Exception):
    """Carries an error in the use of a macro up to where the place of that use is known."""


def expand(text: str, macros: Mapping[str, Macro], active: tuple[str, ...] = ()) -> str:
    """Expand the macros in `text`, except those in `active`, which are being expanded already.

    The expansion of an argument adds "" to `active`, so that the length of `active` is the depth of nesting.
    """
    expanded: list[str] = []
    length = position = 0
    while (match := TOKEN.search(text, position)) is not None:
        before = text[position : match.start()]
        position = match.end()
        use = match.group()
        if use in macros and use not in active:
            use, position = expand_use(text, match, macros, active)
        expanded += (before, use)
        length += len(before) + len(use)
        if length > _LONGEST_EXPANSION:
            raise MacroError(f"macro must expand to at most {_LONGEST_EXPANSION} characters")
    return "".join(expanded) + text[position:]


def expand_use(
    text: str, use: re.Match[str], macros: Mapping[str, Macro], active: tuple[str, ...] = ()
) -> tuple[str, int]:
    """Return what the macro used at `use` becomes, and the position in `text` after its arguments."""
    name = use.group()
    macro = macros[name]
    if len(active) == _DEEPEST_NESTING:
        raise MacroError(f"macros must nest at most {_DEEPEST_NESTING} deep")
    if macro.parameters is None:
        return expand(_substitute(macro.body, {}, macros, active), macros, (*active, name)), use.end()
    listed = _arguments(text, use.end(), name)
    if listed is None:
        return name, use.end()
    arguments, end = listed
    if len(arguments) != len(macro.parameters) and not (arguments == [""] and not macro.parameters):
        raise MacroError(f"macro {name} takes {len(macro.parameters)} arguments, not {len(arguments)}")
    values = dict(zip(macro.parameters, arguments, strict=False))
    return expand(_substitute(macro.body, values, macros, active), macros, (*active, name)), end


def _arguments(text: str, position: int, name: str) -> tuple[list[str], int] | None:
    """Return the arguments in parentheses from `position` on and the position after them; None if there are none."""
    opening = _OPENING.match(text, position)
    if opening is None:
        return None
    arguments, depth, start = [], 1, opening.end()
    for token in _PART_OF_ARGUMENTS.finditer(text, start):
        depth += {"(": 1, ")": -1}.get(token.group(), 0)
        if depth == 0 or (depth == 1 and token.group() == ","):
            arguments.append(text[start : token.start()].strip())
            start = token.end()
        if depth == 0:
            return arguments, start
    raise MacroError(f"arguments of macro {name} must end with ')'")


def _substitute(
    body: str, values: Mapping[str, str], macros: Mapping[str, Macro], active: tuple[str, ...]
) -> str:
    """Put the arguments into a macro's body: as written beside ## and after #, else expanded first."""

    @cache
    def expanded(parameter: str) -> str:
        return expand(values[parameter], macros, (*active, ""))

    pieces: list[str] = []
    position, is_pasted = 0, False
    for piece in _PIECE_OF_BODY.finditer(body):
        pieces.append(body[position : piece.start()])
        position = piece.end()
        word = piece["word"]
        text = piece.group()
        if piece["paste"]:
            text = ""
        elif piece["quoted"] in values:
            text = f'"{values[piece["quoted"]]}"'
        elif word in values:
            is_pasted = is_pasted or body[position:].lstrip().startswith("##")
            text = values[word] if is_pasted else expanded(word)
        is_pasted = bool(piece["paste"])
        pieces.append(text)
    return "".join(pieces) + body[position:]
