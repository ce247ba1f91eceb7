"""LLVM IR as data: functions, blocks and instructions, read from LLVM's own text and written back as such.

Passes of our own (`rewrites`) take a routine and return another one; what is costed, and what is compiled for the host, is read from
the text that they leave. Of the notes behind an instruction, its source line and its branch weights are kept.

In this file: what the text has, how it is said anew with other names and values, how it is read, and how it is written.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from bfsim.kernel.intrinsics import BY_NAME, PREFIX, Intrinsic

DEFINE = re.compile(r"^define .*?@([\w.$-]+)\((.*)\)")
LABEL = re.compile(r"^([\w.$-]+):")
RESULT = re.compile(r"^  (%[\w.$-]+) = (.*)$")
NAME = re.compile(r"%[\w.$-]+")
NUMBERED = re.compile(r"%(\d+)\b|^(\d+)(?=:)", re.MULTILINE)
TARGET = re.compile(r"label (%[\w.$-]+)")
DEBUG = re.compile(r", !dbg !(\d+)")
LOCATION = re.compile(
    r"^!(\d+) = (?:distinct )?!DILocation\(line: (\d+),(?: column: \d+,)? scope: !(\d+)(?:, inlinedAt: !(\d+))?"
)
SUBPROGRAM = re.compile(r'^!(\d+) = distinct !DISubprogram\(name: "([\w.$-]+)"')
PROFILE = re.compile(r", !prof !(\d+)")
WEIGHTS = re.compile(r"^!(\d+) = !\{!\"branch_weights\"(.*)\}")
NOTE = re.compile(r"^!(\d+) = ", re.MULTILINE)
WEIGHT = re.compile(r"i32 (-?\d+)")  # LLVM writes unsigned numbers as signed ones
PHI_ARM = re.compile(r"\[ ([^,\]]+), (%[\w.$-]+) \]")
CASE = re.compile(r"i\d+ (-?\d+), label (%[\w.$-]+)")
WIDTH = re.compile(r"\bi(\d+)\b")
KERNEL_CALL = re.compile(r"\bcall [^@]*@([\w.$-]+)\(")
INTRINSIC = re.compile(rf"@{re.escape(PREFIX)}(\w+)\(")
NO_HINT = (1 << 20, 1)
"""Weights of a branch of which the source says nothing; LLVM takes the first side for certain."""
SWAPPED = {"slt": "sgt", "sgt": "slt", "sle": "sge", "sge": "sle",
           "ult": "ugt", "ugt": "ult", "ule": "uge", "uge": "ule", "eq": "eq", "ne": "ne"}  # fmt: skip
"""Relations by those of the same two values the other way round."""
INVERTED = {"slt": "sge", "sge": "slt", "sle": "sgt", "sgt": "sle",
            "ult": "uge", "uge": "ult", "ule": "ugt", "ugt": "ule", "eq": "ne", "ne": "eq"}  # fmt: skip
"""Relations by those that hold where they do not."""
OPCODE_NOISE = {"tail", "musttail", "notail"}
ENTERS = "bfsim.enters."
"""Before the symbol of a kernel, names a call that does nothing, where the code of that kernel begins, which is inlined."""
STEPS = "bfsim.steps"
"""A call that does nothing, with start, stop and step of the loop behind it, whose step is no constant: `guards` checks them."""
STEPPING = re.compile(
    rf"^  (?:tail )?call void @{re.escape(STEPS)}\(i32 ([^,]+), i32 ([^,]+), i32 ([^,)]+)\)"
)
OF_VARIABLE = "cut.variable"
"""In the name of what a store cuts off a local variable, and of what LLVM makes of that: in C the variable is a whole word until then."""
HIDES = "bfsim.hides"
"""A call that returns its number, of which LLVM is to know nothing."""
ENTRY = re.compile(rf"^  (?:tail )?call void @{re.escape(ENTERS)}([\w.$-]+)\(")


class SourceLine(NamedTuple):
    """Where an operation comes from: a line of the kernel `routine`. `site`: LLVM's number of the call that was inlined, 0 if none was."""

    routine: str
    line: int
    site: int = 0


class Entrance(NamedTuple):
    """Where the code of the kernel `symbol` begins, called from the line `caller`; `location` is the number of its note."""

    symbol: str
    caller: SourceLine
    location: str = ""


@dataclass(frozen=True, slots=True)
class Instruction:
    """One instruction. `operands` are the texts of its value operands: names such as %x, or constants."""

    result: str | None
    opcode: str
    text: str
    operands: tuple[str, ...]
    line: SourceLine
    weights: tuple[int, ...] = ()
    """Of a branch: how likely each side is, where the source gives a hint."""
    location: str = ""
    """Number of the note that has its source line."""
    hint: str = ""
    """Number of the note that has its weights; empty if there is none yet."""

    @property
    def row(self) -> str:
        """The instruction as a line of LLVM's text."""
        target = f"{self.result} = " if self.result else ""
        location = f", !dbg !{self.location}" if self.location else ""
        return f"  {target}{self.text}{location}{f', !prof !{self.hint}' if self.hint else ''}"

    @property
    def is_division(self) -> bool:
        """Whether the Blackfin has no instruction for it, but a routine in the run-time library."""
        return self.opcode in ("sdiv", "udiv", "srem", "urem")

    @property
    def is_soft_float(self) -> bool:
        """Whether it calls the soft-float library."""
        named = self.opcode == "call" and ("@llvm.sqrt" in self.text or "@llvm.fpto" in self.text)
        return named or self.opcode in ("fadd", "fsub", "fmul", "fdiv", "fcmp", "sitofp", "uitofp")

    @property
    def is_call(self) -> bool:
        """Whether it is a call of another kernel."""
        return self.opcode == "call" and not self.is_computation and not self.is_mark

    @property
    def is_mark(self) -> bool:
        """Whether it is no code, and only says what is to be checked here."""
        return self.opcode == "call" and f"@{STEPS}(" in self.text

    @property
    def is_computation(self) -> bool:
        """Whether it is a call by which LLVM, or the kernel language, writes an operation."""
        names = ("@llvm.", f"@{PREFIX}", f"@{HIDES}")
        return self.opcode == "call" and any(each in self.text for each in names)

    @property
    def intrinsic(self) -> Intrinsic | None:
        """The intrinsic that it calls."""
        found = INTRINSIC.search(self.text) if self.opcode == "call" else None
        return BY_NAME[found[1]] if found else None

    @property
    def bits(self) -> int:
        """Width of the value that it loads, stores, extends or computes."""
        found = WIDTH.search(self.text) if " float" not in self.text else None
        return int(found.group(1)) if found else 32


@dataclass(frozen=True, slots=True)
class BasicBlock:
    """A basic block: phi nodes, other instructions, terminator last. Labels are written without %."""

    label: str
    instructions: tuple[Instruction, ...]
    enters: tuple[Entrance, ...] = ()
    """Of the inlined kernels whose code begins here."""

    def rows(self) -> Iterator[str]:
        """The block as LLVM's text."""
        yield f"{self.label}:"
        phis = [each for each in self.instructions if each.opcode == "phi"]
        yield from (each.row for each in phis)
        for entrance in self.enters:
            location = f", !dbg !{entrance.location}" if entrance.location else ""
            yield f"  call void @{ENTERS}{entrance.symbol}(){location}"
        yield from (each.row for each in self.instructions[len(phis) :])

    @property
    def terminator(self) -> Instruction:
        """The last instruction."""
        return self.instructions[-1]

    @property
    def successors(self) -> tuple[str, ...]:
        """Labels that the terminator can go to: of a branch the true side first, of a switch the default first."""
        return tuple(each[1:] for each in TARGET.findall(self.terminator.text))

    @property
    def cases(self) -> tuple[tuple[int, str], ...]:
        """(value, label) of each case of a switch."""
        return tuple((int(value), label[1:]) for value, label in CASE.findall(self.terminator.text))


@dataclass(frozen=True, slots=True)
class Routine:
    """A function of the module."""

    symbol: str
    parameters: tuple[str, ...]
    blocks: tuple[BasicBlock, ...]


def without_marks(routine: Routine) -> Routine:
    """Return `routine` as the Blackfin has it, which checks nothing."""
    blocks = (
        replace(block, instructions=tuple(each for each in block.instructions if not each.is_mark))
        for block in routine.blocks
    )
    return replace(routine, blocks=tuple(blocks))


def arms_of(phi: Instruction) -> dict[str, str]:
    """Return the values of a phi by the labels of the blocks that they come from."""
    return {label[1:]: value for value, label in PHI_ARM.findall(phi.text)}


def with_values(phi: Instruction, arms: Mapping[str, str]) -> Instruction:
    """Return a phi of other values, by the labels of the blocks that they come from."""
    text = ", ".join(f"[ {value}, %{label} ]" for label, value in arms.items())
    return replace(phi, text=f"phi {phi.text.split()[1]} {text}", operands=tuple(arms.values()))


def renamed(each: Instruction, names: Mapping[str, str]) -> Instruction:
    """Return an instruction that reads what `names` has in place of the values named there."""
    if not any(name in names for name in each.operands):
        return each
    text = NAME.sub(lambda found: names.get(found[0], found[0]), each.text)
    return replace(each, text=text, operands=tuple(names.get(name, name) for name in each.operands))


def written(result: str, text: str, operands: tuple[str, ...], at: Instruction) -> Instruction:
    """Return the instruction `text`, of the same place in the source as the instruction `at`."""
    return Instruction(result, text.split(maxsplit=1)[0], text, operands, at.line, location=at.location)


def is_number(value: str) -> bool:
    """Whether a value is an integer of the text."""
    return value.lstrip("-").isdigit()


def predicate(compare: Instruction) -> str:
    """Return the relation that an `icmp` or `fcmp` tests: eq, slt, ult, ..."""
    words = compare.text.split()
    return words[2] if words[1] in ("samesign", "fast") else words[1]


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
    """Return through which routines each inlined call came, by its number: the one that it was inlined into comes first."""
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
    """Return the source line of each note of one, by the note's number.

    Line 0 is LLVM's word for code merged from several lines: it is no note, so that the code stays with the line before it.
    """
    routines = {found[1]: found[2] for found in map(SUBPROGRAM.match, text.splitlines()) if found}
    notes = [found for found in map(LOCATION.match, text.splitlines()) if found and found[2] != "0"]
    return {each[1]: SourceLine(routines[each[3]], int(each[2]), int(each[4] or 0)) for each in notes}


def _matches(pattern: re.Pattern[str], text: str) -> list[tuple[str, str]]:
    return [(m.group(1), m.group(2)) for m in map(pattern.match, text.splitlines()) if m]


def _joined(body: list[str]) -> list[str]:
    """Put the cases of a switch, which LLVM writes on lines of their own, behind it."""
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
            debug = DEBUG.search(row)
            location = debug.group(1) if debug else ""
            enters.append(Entrance(found.group(1), lines_of.get(location, line), location))
        elif row.startswith("  "):
            debug = DEBUG.search(row)
            location = debug.group(1) if debug else ""
            line = lines_of.get(location, line)
            found_hint = PROFILE.search(row)
            hint = found_hint.group(1) if found_hint else ""
            weights = weights_of.get(hint, ())
            instructions.append(_instruction(row, line, weights, location, hint if weights else ""))
            if instructions[-1].opcode in ("br", "ret", "switch", "unreachable"):
                blocks.append(BasicBlock(label, tuple(instructions), tuple(enters)))
    return tuple(blocks)


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


def with_names(text: str) -> str:
    """Return a module in which every value and block has a name: LLVM numbers the others by their order, which passes change.

    The names are other ones than those of an earlier time.
    """
    mark = ".n"
    while f"%{mark}" in text:
        mark += "n"
    return NUMBERED.sub(lambda found: f"%{mark}{found[1]}" if found[1] else f"{mark}{found[2]}", text)


def write_module(text: str, routines: Sequence[Routine]) -> str:
    """Return the module `text` with `routines`, one for each of its functions and in their order, as their bodies.

    Weights that stand in no note yet are noted.
    """
    notes = dict[tuple[int, ...], str]()
    first = max(map(int, NOTE.findall(text)), default=-1) + 1

    def noted(each: Instruction) -> Instruction:
        if not each.weights or each.hint:
            return each
        return replace(each, hint=notes.setdefault(each.weights, str(first + len(notes))))

    bodies = [
        replace(
            routine,
            blocks=tuple(
                replace(block, instructions=tuple(map(noted, block.instructions))) for block in routine.blocks
            ),
        )
        for routine in routines
    ]
    words = (
        f'!{number} = !{{!"branch_weights", {", ".join(f"i32 {each}" for each in weights)}}}'
        for weights, number in notes.items()
    )
    return "\n".join((*_rows(text, iter(bodies)), *words))


def _rows(text: str, routines: Iterator[Routine]) -> Iterator[str]:
    rows = iter(text.splitlines())
    for row in rows:
        yield row
        if DEFINE.match(row):
            for block in next(routines).blocks:
                yield from block.rows()
            yield next(each for each in rows if each == "}")
