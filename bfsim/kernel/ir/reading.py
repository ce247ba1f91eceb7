"""LLVM IR read: from LLVM's own text, the functions of a module and where their code comes from.

Of the notes on an instruction, its source line and its branch weights are kept.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from bfsim.kernel.ir.text import (
    ENTERS,
    NAME,
    PHI_ARM,
    STEPS,
    BasicBlock,
    Entrance,
    Instruction,
    Routine,
    SourceLine,
)

DEFINE = re.compile(r"^define .*?@([\w.$-]+)\((.*)\)")
LABEL = re.compile(r"^([\w.$-]+):")
RESULT = re.compile(r"^  (%[\w.$-]+) = (.*)$")
DEBUG = re.compile(r", !dbg !(\d+)")
LOCATION = re.compile(
    r"^!(\d+) = (?:distinct )?!DILocation\(line: (\d+),(?: column: \d+,)? scope: !(\d+)(?:, inlinedAt: !(\d+))?"
)
SUBPROGRAM = re.compile(r'^!(\d+) = distinct !DISubprogram\(name: "([\w.$-]+)"')
PROFILE = re.compile(r", !prof !(\d+)")
WEIGHTS = re.compile(r"^!(\d+) = !\{!\"branch_weights\"(.*)\}")
WEIGHT = re.compile(r"i32 (-?\d+)")  # LLVM writes unsigned numbers as signed ones
KERNEL_CALL = re.compile(r"\bcall [^@]*@([\w.$-]+)\(")
STEPPING = re.compile(
    rf"^  (?:tail )?call void @{re.escape(STEPS)}\(i32 ([^,]+), i32 ([^,]+), i32 ([^,)]+)\)"
)
ENTRY = re.compile(rf"^  (?:tail )?call void @{re.escape(ENTERS)}([\w.$-]+)\(")
OPCODE_NOISE = {"tail", "musttail", "notail"}


def read_module(text: str) -> tuple[Routine, ...]:
    """Read every function definition of an LLVM module."""
    weights_of = {
        number: tuple(int(each) & 0xFFFFFFFF for each in WEIGHT.findall(row))
        for number, row in _matches(WEIGHTS, text)
    }
    lines_of = _source_lines(text)
    routines = []
    rows = iter(text.splitlines())
    for row in rows:
        if found := DEFINE.match(row):
            body = []
            for inner in rows:
                if inner == "}":
                    break
                body.append(inner)
            parameters = tuple(NAME.findall(found.group(2)))
            first = SourceLine(found.group(1), 1)
            routines.append(
                Routine(first.routine, parameters, _blocks(_joined(body), first, lines_of, weights_of))
            )
    return tuple(routines)


def inlined_through(text: str) -> dict[int, tuple[str, ...]]:
    """Return the routines through which each inlined call came, by its number, beginning with the one it was inlined into."""
    lines_of = _source_lines(text)
    found: dict[int, tuple[str, ...]] = {}
    for site in {line.site for line in lines_of.values()} - {0}:
        through, number = [], site
        while number and (line := lines_of.get(str(number))):
            through.append(line.routine)
            number = line.site
        found[site] = tuple(reversed(through))
    return found


def placed_rows(text: str) -> Iterator[tuple[str, str, str]]:
    """Yield each row of a module, with the symbol of the routine and the label of the block that it stands in."""
    symbol = label = ""
    for row in text.splitlines():
        if found := DEFINE.match(row):
            symbol = found.group(1)
        elif found := LABEL.match(row):
            label = found.group(1)
        yield symbol, label, row


def _source_lines(text: str) -> dict[str, SourceLine]:
    """Return the source lines that notes name, by the note's number.

    Line 0 is LLVM's mark of code merged from several lines: it is left out, so that the code stays with the line before
    it.
    """
    routines = {found[1]: found[2] for found in map(SUBPROGRAM.match, text.splitlines()) if found}
    notes = [found for found in map(LOCATION.match, text.splitlines()) if found and found[2] != "0"]
    return {each[1]: SourceLine(routines[each[3]], int(each[2]), int(each[4] or 0)) for each in notes}


def _matches(pattern: re.Pattern[str], text: str) -> list[tuple[str, str]]:
    return [(m.group(1), m.group(2)) for m in map(pattern.match, text.splitlines()) if m]


def _joined(body: list[str]) -> list[str]:
    """Join the cases of a switch, which LLVM writes on lines of their own, to its first line."""
    rows: list[str] = []
    for row in body:
        if row.startswith(("    i", "  ]")):
            rows[-1] += " " + row.strip()
        else:
            rows.append(row)
    return rows


def _blocks(
    rows: list[str], line: SourceLine, lines_of: dict[str, SourceLine], weights_of: dict[str, tuple[int, ...]]
) -> tuple[BasicBlock, ...]:
    """Read the blocks of a routine; `line` is its first one."""
    blocks: list[BasicBlock] = []
    label, instructions, enters = "", list[Instruction](), list[Entrance]()
    for row in rows:
        if found := LABEL.match(row):
            label, instructions, enters = found.group(1), [], []
        elif found := ENTRY.match(row):
            location = _number(DEBUG, row)
            enters.append(Entrance(found.group(1), lines_of.get(location, line), location))
        elif row.startswith("  "):
            location, hint = _number(DEBUG, row), _number(PROFILE, row)
            line = lines_of.get(location, line)
            weights = weights_of.get(hint, ())
            instructions.append(_instruction(row, line, weights, location, hint if weights else ""))
            if instructions[-1].opcode in ("br", "ret", "switch", "unreachable"):
                blocks.append(BasicBlock(label, tuple(instructions), tuple(enters)))
    return tuple(blocks)


def _number(note: re.Pattern[str], row: str) -> str:
    """Return the number of a row's note of a kind; '' if there is none."""
    found = note.search(row)
    return found.group(1) if found else ""


def _instruction(
    row: str, line: SourceLine, weights: tuple[int, ...], location: str, hint: str
) -> Instruction:
    text = DEBUG.sub("", row).split(", !")[0].strip()
    found = RESULT.match(row)
    result = found.group(1) if found else None
    body = text.split(" = ", 1)[1] if result else text
    words = [word for word in body.split() if word not in OPCODE_NOISE]
    return Instruction(result, words[0], body, _operands(words[0], body), line, weights, location, hint)


def _operands(opcode: str, body: str) -> tuple[str, ...]:
    if opcode == "phi":
        return tuple(value for value, _ in PHI_ARM.findall(body))
    if opcode == "call":
        inside = body[body.index("(", body.index("@")) + 1 : body.rindex(")")]
        return tuple(part.split()[-1] for part in inside.split(",") if part.strip())
    if opcode in ("br", "switch"):
        return tuple(NAME.findall(body.split("label %", maxsplit=1)[0]))
    body = re.sub(r", align \d+$", "", body)
    return tuple(part.split()[-1] for part in re.split(r",(?![^(]*\))", body.replace(" to ", ", "))
                 if part.split() and (part.split()[-1].startswith(("%", "@")) or _is_constant(part.split()[-1])))  # fmt: skip


def _is_constant(word: str) -> bool:
    return bool(re.fullmatch(r"-?\d+|true|false|null|poison|-?\d+\.\d+e[+-]\d+|0x[0-9A-F]+", word))
