"""The LDF preprocessor: files in, one text out, without comments, macros, conditions and inclusions."""

from __future__ import annotations

import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from bfsim.errors import LinkError, cut, shown
from bfsim.files.content import read_bounded
from bfsim.linker.conditions import holds
from bfsim.linker.macros import TOKEN, Macro, MacroError, Macros, expand_use
from bfsim.linker.predefined import chip_in, macros_for
from bfsim.linker.source import File, Fragment, Source

_DIRECTIVE = re.compile(r"\s*#\s*(?P<name>\w*)(?P<rest>.*)", re.DOTALL)
_DEFINE = re.compile(
    r"\s*(?P<name>[A-Za-z_]\w*)(?:\((?P<parameters>[\w\s,]*)\)|(?!\())(?P<body>.*)", re.DOTALL
)
_NAME = re.compile(r"\s*(?P<name>[A-Za-z_]\w*)\s*")
_INCLUDED = re.compile(r'\s*(?:"(?P<beside>[^"\n]+)"|<(?P<listed>[^>\n]+)>)\s*')
_GOES_ON = re.compile(r"//[^\n]*\\[ \t\r]*\n(?!\s*?(?://|$))", re.MULTILINE)
"""A comment that includes the next line, as in C, if that line says something."""
_INCLUDE_COMMAND = re.compile(r'INCLUDE\s*\(\s*"?(?P<beside>[^")\n]+?)"?\s*\)\s*;?')
Text = tuple[str, File, int, bool]
"""A piece of expanded text, the file and the offset where it was written, and whether it is a copy of what was written."""

_CONDITIONS = ("if", "ifdef", "ifndef", "elif", "else", "endif")
_NEEDED = {"define": "a macro", "undef": "the name of a macro", "include": 'a file in "" or <>'}
_IGNORED = {"", "pragma", "line", "ident"}

# Bounds for inclusions that were written to explode; the default LDFs of VisualDSP++ include one file.
_DEEPEST_INCLUSION = 20
_MOST_INCLUSIONS = 500


@dataclass(slots=True)
class _Condition:
    """An #if: whether the text around it is read, its current branch is taken, or a branch was taken before."""

    offset: int
    is_read: bool
    is_taken: bool
    was_taken: bool
    has_else: bool = False


@dataclass(slots=True)
class _Preprocessor:
    """One run: the macros as they are defined now, and what has been included."""

    macros: Macros
    include_dirs: Sequence[Path]
    warnings: list[str] = field(default_factory=list)
    inclusions: int = 0

    def pieces(self, file: File, active: tuple[Path, ...]) -> Iterator[Text]:
        """Yield the expanded text of a file, which the files `active` include."""
        written, conditions, position = file.written, list[_Condition](), 0
        copied = 0  # the text up to here is yielded or left out
        while (match := TOKEN.search(written, position)) is not None:
            start, position, kind = match.start(), match.end(), match.lastgroup
            _require_end(file, match)
            is_taken = not conditions or conditions[-1].is_taken
            word = match.group() if is_taken and kind == "word" else ""
            is_macro = word in self.macros
            command = _INCLUDE_COMMAND.match(written, start) if word == "INCLUDE" and not is_macro else None
            if not (is_macro or command or kind in ("directive", "comment")):
                continue
            if is_taken:
                yield written[copied:start], file, copied, True
            if kind == "directive":
                yield from self._obey(file, match, conditions, active)
            elif command:
                position = command.end()
                yield from self._include(file, start, command["beside"], is_beside=True, active=active)
            elif is_macro:
                text, position = self._expanded(file, match)
                yield text, file, start, False
            elif is_taken:  # a comment
                yield " ", file, start, False
            copied = position
        if conditions:
            raise file.error_at(conditions[-1].offset, "#if must end with #endif before the file does")
        yield written[copied:], file, copied, True

    def _expanded(self, file: File, use: re.Match[str]) -> tuple[str, int]:
        try:
            return expand_use(file.written, use, self.macros)
        except MacroError as error:
            raise file.error_at(use.start(), str(error)) from None

    def _obey(
        self, file: File, match: re.Match[str], conditions: list[_Condition], active: tuple[Path, ...]
    ) -> Iterator[Text]:
        """Do what a directive says; yield the text that it includes."""
        text = re.sub(r"/\*.*?\*/", " ", re.sub(r"\\\r?\n", " ", match.group()), flags=re.DOTALL)
        directive = _DIRECTIVE.fullmatch(text)
        assert directive is not None
        name, rest = directive["name"], directive["rest"].strip()
        offset = match.start() + match.group().index("#")
        if name in _CONDITIONS:
            self._branch(file, offset, name, rest, conditions)
        elif conditions and not conditions[-1].is_taken:
            return
        elif name == "include" and (included := _INCLUDED.fullmatch(rest)):
            wanted = included["beside"] or included["listed"]
            is_beside = included["beside"] is not None
            yield from self._include(file, offset, wanted, is_beside=is_beside, active=active)
        elif name == "define" and (define := _DEFINE.fullmatch(rest)):
            self.macros[define["name"]] = _macro(define)
        elif name == "undef" and (undef := _NAME.fullmatch(rest)):
            self.macros.pop(undef["name"], None)
        elif name == "error":
            raise file.error_at(offset, f"#error {cut(rest)}".rstrip())
        elif name == "warning":
            self.warnings.append(f"{file.place_of(offset)}: {rest}")
        elif name in _NEEDED:
            raise file.error_at(offset, f"#{name} must be followed by {_NEEDED[name]}, not '{cut(rest)}'")
        elif name not in _IGNORED:
            known = ", ".join(f"#{each}" for each in (*_CONDITIONS, *_NEEDED, "error", "warning", "pragma"))
            raise file.error_at(offset, f"preprocessor line must be one of {known}, not '#{cut(name)}'")

    def _branch(self, file: File, offset: int, name: str, rest: str, conditions: list[_Condition]) -> None:
        """Enter, change or leave a condition."""
        if name in ("if", "ifdef", "ifndef"):
            is_read = not conditions or conditions[-1].is_taken
            is_true = is_read and self._is_true(file, offset, name, rest)
            conditions.append(_Condition(offset, is_read, is_true, is_true))
            return
        if not conditions:
            raise file.error_at(offset, f"#{name} must follow an #if")
        if name == "endif":
            conditions.pop()
            return
        condition = conditions[-1]
        if condition.has_else:
            raise file.error_at(offset, f"#{name} must not follow the #else of its #if")
        condition.has_else = name == "else"
        may_take = condition.is_read and not condition.was_taken
        condition.is_taken = may_take and (name == "else" or self._is_true(file, offset, "if", rest))
        condition.was_taken |= condition.is_taken

    def _is_true(self, file: File, offset: int, name: str, rest: str) -> bool:
        if name == "if":
            try:
                return holds(rest, self.macros)
            except MacroError as error:
                raise file.error_at(offset, str(error)) from None
        named = _NAME.match(rest)
        if named is None:
            raise file.error_at(offset, f"#{name} must name a macro, not {shown(rest)}")
        return (named["name"] in self.macros) == (name == "ifdef")

    def _include(
        self, file: File, offset: int, wanted: str, *, is_beside: bool, active: tuple[Path, ...]
    ) -> Iterator[Text]:
        """Yield the text of the file `wanted`, from beside `file` or from the first of the include folders."""
        self.inclusions += 1
        if len(active) > _DEEPEST_INCLUSION or self.inclusions > _MOST_INCLUSIONS:
            limits = f"{_DEEPEST_INCLUSION} deep and {_MOST_INCLUSIONS} in all"
            raise file.error_at(offset, f"inclusions must be at most {limits}")
        folders = [*([file.path.parent] if is_beside else []), *self.include_dirs]
        for folder in folders:
            path = folder / wanted.replace("\\", "/")
            try:
                written, resolved = _read(path), path.resolve()
            except (OSError, ValueError, RuntimeError):  # the last two: no name at all, a circle of links
                continue
            if resolved in active:
                raise file.error_at(offset, f"file must not include itself, not {shown(wanted)}")
            yield from self.pieces(File(path, written, file.place_of(offset)), (*active, resolved))
            return
        searched = cut(", ".join(map(str, folders))) or "no folder"
        raise file.error_at(
            offset,
            f"included file must be a readable one, not '{cut(wanted)}' (sought in {searched}); -I FOLDER looks there, too",
        )


def preprocess(path: Path, macros: Mapping[str, str], include_dirs: Sequence[Path], chip: str) -> Source:
    """Read an LDF with `macros` besides the predefined ones, expand macros, blank comments; raise LinkError if it cannot.

    The macros of a chip are those of its ARCHITECTURE, whichever file has it; without one, those of `chip`.
    """
    try:
        file = File(path, _read(path))
    except (OSError, ValueError) as error:
        raise LinkError(
            f"LDF must be a readable file, not {path} ({getattr(error, 'strerror', error)})"
        ) from None
    try:
        source = _expanded(file, macros_for(chip) | dict(macros), include_dirs)
        named = chip_in(source.expanded)
        if named in ("", chip):
            return source
    except LinkError:  # it may be for one chip only, and say so with #error or in what it includes
        named = chip_in(file.written)
        if named in ("", chip):
            raise
    return _expanded(file, macros_for(named) | dict(macros), include_dirs)


def _expanded(file: File, defined: Mapping[str, str], include_dirs: Sequence[Path]) -> Source:
    run = _Preprocessor({name: Macro(None, body) for name, body in defined.items()}, include_dirs)
    expanded: list[str] = []
    pieces: list[Fragment] = []
    length = 0
    for text, written_in, written_at, is_copy in run.pieces(file, (file.path.resolve(),)):
        pieces.append(Fragment(length, written_in, written_at, is_copy))
        expanded.append(text)
        length += len(text)
    return Source(file.path, "".join(expanded), tuple(pieces), tuple(run.warnings))


def _read(path: Path) -> str:
    """Return the text of a file, read as UTF-16 if it begins with that mark, as editors on Windows write it.

    A lone carriage return ends a line, too, as on old Macintoshes and where a line feed was lost.
    """
    content = read_bounded(path)
    is_utf_16 = content.startswith((BOM_UTF16_LE, BOM_UTF16_BE))
    text = content.decode("utf-16" if is_utf_16 else "utf-8-sig", errors="replace")
    return re.sub(r"\r(?!\n)", "\n", text)


def _require_end(file: File, token: re.Match[str]) -> None:
    """Raise LinkError for a comment that does not end where it seems to."""
    start = token.start()
    if token.lastgroup == "unclosed":
        raise file.error_at(start, "comment must end with */ before the file does")
    if token.lastgroup == "comment" and _GOES_ON.match(file.written, start):
        raise file.error_at(
            start, "comment must not end in \\, which makes the next line a part of it; write a . behind it"
        )


def _macro(define: re.Match[str]) -> Macro:
    listed = define["parameters"]
    names = None if listed is None else tuple(name.strip() for name in listed.split(",") if name.strip())
    return Macro(names, define["body"].strip())
