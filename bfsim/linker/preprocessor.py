"""The LDF preprocessor: takes comments out and macros in. Conditional text and #include are refused."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from bfsim.errors import LinkError
from bfsim.linker.source import Piece, Source, error_in

_TOKEN = re.compile(
    r"""(?P<directive> ^[ \t]*\#(?:\\\n|[^\n])* )
      | (?P<comment>   /\*.*?\*/ | //[^\n]* )
      | (?P<unclosed>  /\* )
      | (?P<string>    "[^"\n]*" )
      | (?P<word>      \$?\w+ )""",
    re.VERBOSE | re.MULTILINE | re.DOTALL,
)
_DEFINE = re.compile(r"\s*#\s*define\s+(?P<name>[A-Za-z_]\w*)(?:\((?P<parameters>[\w\s,]*)\))?(?P<body>.*)")
_UNDEF = re.compile(r"\s*#\s*undef\s+(?P<name>[A-Za-z_]\w*)\s*")
_ARGUMENTS = re.compile(r"\s*\(([^()]*)\)")
_PASTE = re.compile(r"\s*##\s*")

# Bounds for macros that were written to explode; the default LDFs of VisualDSP++ stay below 3 and 1000.
_DEEPEST_NESTING = 50
_LONGEST_EXPANSION = 100_000


@dataclass(frozen=True, slots=True)
class Macro:
    """A #define: `parameters` is None for one without parentheses."""

    parameters: tuple[str, ...] | None
    body: str


class _MacroError(Exception):
    """Carries what is wrong with the use of a macro up to where the place of that use is known."""


def preprocess(path: Path) -> Source:
    """Read an LDF, expand its macros and blank its comments; LinkError if a part cannot be read."""
    try:
        written = path.read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        raise LinkError(f"LDF must be a readable file, not {path} ({error.strerror})") from None
    expanded: list[str] = []
    pieces: list[Piece] = []
    length = 0
    for text, written_at, is_copy in _pieces(path, written):
        pieces.append(Piece(length, written_at, is_copy))
        expanded.append(text)
        length += len(text)
    return Source(path, written, "".join(expanded), tuple(pieces))


def _pieces(path: Path, written: str) -> Iterator[tuple[str, int, bool]]:
    """Yield the expanded text in pieces: the text, where it was written, whether it was written just so."""
    macros: dict[str, Macro] = {}
    position = 0
    while (match := _TOKEN.search(written, position)) is not None:
        start = match.start()
        yield written[position:start], position, True
        position = match.end()
        match match.lastgroup:
            case "directive":
                _obey(path, written, match, macros)
            case "comment":
                yield " ", start, False
            case "unclosed":
                raise error_in(path, written, start, "comment must end with */ before the file does")
            case "word" if match.group() in macros:
                try:
                    text, position = _expand_use(written, match, macros, frozenset())
                except _MacroError as error:
                    raise error_in(path, written, start, str(error)) from None
                yield text, start, False
            case _:
                yield match.group(), start, True
    yield written[position:], position, True


def _obey(path: Path, written: str, directive: re.Match[str], macros: dict[str, Macro]) -> None:
    """Enter a #define into `macros` or take an #undef out; refuse every other directive."""
    text = re.sub(r"/\*.*?\*/|//.*", " ", directive.group().replace("\\\n", " "))
    if define := _DEFINE.fullmatch(text):
        listed = define["parameters"]
        parameters = None if listed is None else tuple(name.strip() for name in listed.split(","))
        macros[define["name"]] = Macro(parameters, define["body"].strip())
    elif undef := _UNDEF.fullmatch(text):
        macros.pop(undef["name"], None)
    else:
        offset = directive.start() + directive.group().index("#")
        raise error_in(
            path, written, offset, f"preprocessor line must be #define or #undef, not {text.strip()!r}"
        )


def _expand_use(
    text: str, use: re.Match[str], macros: Mapping[str, Macro], active: frozenset[str]
) -> tuple[str, int]:
    """Return what the macro used at `use` becomes, and the position in `text` behind its arguments."""
    name = use.group()
    macro = macros[name]
    body, end = macro.body, use.end()
    if macro.parameters is not None:
        listed = _ARGUMENTS.match(text, end)
        if listed is None:
            return name, end
        arguments = [argument.strip() for argument in listed[1].split(",")]
        if len(arguments) != len(macro.parameters):
            raise _MacroError(f"macro {name} takes {len(macro.parameters)} arguments, not {len(arguments)}")
        values = dict(zip(macro.parameters, arguments, strict=True))
        body, end = re.sub(r"\w+", lambda word: values.get(word[0], word[0]), body), listed.end()
    if len(active) == _DEEPEST_NESTING:
        raise _MacroError(f"macros must nest at most {_DEEPEST_NESTING} deep")
    return _expand_body(_PASTE.sub("", body), macros, active | {name}), end


def _expand_body(body: str, macros: Mapping[str, Macro], active: frozenset[str]) -> str:
    """Expand the macros in a macro's body, but those that are being expanded already, as C does."""
    expanded: list[str] = []
    length = position = 0
    while (match := _TOKEN.search(body, position)) is not None:
        text = body[position : match.start()]
        position = match.end()
        use = match.group()
        if use in macros and use not in active:
            use, position = _expand_use(body, match, macros, active)
        expanded += (text, use)
        length += len(text) + len(use)
        if length > _LONGEST_EXPANSION:
            raise _MacroError(f"macro must expand to at most {_LONGEST_EXPANSION} characters")
    return "".join(expanded) + body[position:]
