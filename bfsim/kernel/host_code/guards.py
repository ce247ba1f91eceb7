"""Guards, written into the text of the optimised IR: they check every index before its access, every divisor, and every step.

In unoptimised code they check shift counts, too; in optimised code LLVM may have changed all but the lower five bits.

The IR has been costed by then: guards cost the host time, and the Blackfin nothing. An access goes to the element at
its distance from the array's first one, modulo 2**32 as in the chip's registers, and only if the array has that
element. The first guard that fails notes its number and two values, and the whole call of the kernel ends there.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import takewhile

from bfsim.kernel.host_code.entry import RETURN
from bfsim.kernel.host_code.guard_routines import DIVISIBLE, ELEMENT, ENDS, FAIL, SHIFTS
from bfsim.kernel.host_code.pointers import Origin, Pointers, nbytes_of
from bfsim.kernel.ir.reading import DEFINE, KERNEL_CALL, LABEL, STEPPING
from bfsim.kernel.ir.text import COUNTS
from bfsim.kernel.language import tree

ACCESS = re.compile(r"^(  (?:%[\w.$-]+ = load|store) (i\d+|float)(?: [^,]+)?, ptr )(%[\w.$-]+)(.*)$")
DIVISION = re.compile(r"^  %[\w.$-]+ = ([su])(?:div|rem)(?: exact)? (i\d+) ([^,]+), ([^,]+)")
MASK = re.compile(rf"^  (%{re.escape(COUNTS)}[\d.]*) = and i32 ([^,]+), 31\b")
SHIFT = re.compile(r"^  %[\w.$-]+ = (?:shl|lshr|ashr) i32 [^,]+, (%[\w.$-]+)")
DEBUG = re.compile(r"!dbg !(\d+)")
LOCATION = re.compile(r"^!(\d+) = (?:distinct )?!DILocation\((.*)\)")
FIELD = re.compile(r"(\w+): !?(\d+)")
SCOPE = re.compile(r'^!(\d+) = distinct !DISubprogram\(name: "([^"]+)"')

NUMBER, FIRST, SECOND, CALLS = range(4)
"""Words of the note: the guard that failed and its two values; then, for each routine, the place that called it last."""
JUMP_WORDS = 128  # no C library's jmp_buf has more


class Shift:
    """Stands for a shift in a guard; unlike everything else that is guarded, it has no number in the source."""


Node = type[tree.Load | tree.Store | tree.Binary | tree.For | tree.KernelCall | Shift]


@dataclass(frozen=True, slots=True)
class SourcePlace:
    """A place in the source. `site` is the number of an access or division in `routine` (see `emit.sites_of`).

    It is 0 if there is none or LLVM has merged several; `line` is 0 if LLVM has merged several lines.
    """

    routine: str
    line: int
    site: int


@dataclass(frozen=True, slots=True)
class Guard:
    """What a number in the note stands for: an access, a division, a loop in steps, or a call of another kernel (`node`).

    `places`: its place; if that was inlined, then the place of the inlined call, and so on. `array`: the parameter that
    it accesses, if that is known.
    """

    node: Node
    routine: str
    places: tuple[SourcePlace, ...]
    array: str | None


def note_name(entry: str) -> str:
    """Return the name of the variable in which the first failure is noted."""
    return f"{entry}_note"


class Guarded:
    """The module `text` with guards, for the entry point `entry`; `shifts`: of shifts, too, since nothing was optimised."""

    def __init__(self, text: str, entry: str, *, shifts: bool) -> None:
        rows = text.splitlines()
        self._note = f"@{note_name(entry)}"
        self._places = _places(rows)
        self._kinds: set[str] = set()
        self._divisions: set[tuple[str, str]] = set()
        self._has_steps = False
        self._shifts = shifts
        self._routine = ""
        self.guards: list[Guard] = []
        """Guards and calls by their numbers, which begin with 1."""
        self.routines = [found[1] for found in map(DEFINE.match, rows) if found]
        """Routines by the numbers of their words in the note."""
        self.text = "\n".join(self._module(rows))

    @property
    def note_words(self) -> int:
        """Length of the note."""
        return CALLS + len(self.routines)

    def run_time(self) -> str:
        """Return the variables and routines that the guards use."""
        rows = [
            f"{self._note} = global [{self.note_words} x i64] zeroinitializer",
            f"{RETURN} = internal global [{JUMP_WORDS} x i64] zeroinitializer, align 16",
            FAIL.format(note=self._note),
        ]
        rows += [
            ELEMENT.format(kind=each, shift=nbytes_of(each).bit_length() - 1) for each in sorted(self._kinds)
        ]
        for sign, kind in sorted(self._divisions):
            signed, extend = ("true", "sext") if sign == "s" else ("false", "zext")
            lowest = -1 << int(kind[1:]) - 1
            rows.append(DIVISIBLE.format(sign=sign, kind=kind, lowest=lowest, signed=signed, extend=extend))
        if self._has_steps:
            rows.append(ENDS)
        if self._shifts:
            rows.append(SHIFTS)
        return "\n".join(rows)

    def _module(self, rows: list[str]) -> Iterator[str]:
        waiting = iter(rows)
        for row in waiting:
            yield row
            if found := DEFINE.match(row):
                self._routine = found[1]
                body = list(takewhile(lambda each: each != "}", waiting))
                yield from self._body(Pointers(found[2], body), body)
                yield "}"

    def _body(self, pointers: Pointers, body: list[str]) -> Iterator[str]:
        checked: dict[tuple[str, str], str] = {}
        mask = None  # that of the row before
        for row in body:
            if LABEL.match(row):
                checked = {}  # what this block has checked already
            if (access := ACCESS.match(row)) and not pointers.is_local(access[3]):
                pointer = access[3], access[2]
                if pointer not in checked:
                    number = self._number(
                        row, tree.Load if " = load " in row else tree.Store, pointers.array(access[3])
                    )
                    checked[pointer] = f"%.element.{number}"
                    yield self._check_index(pointers.origin(access[3]), access[2], number)
                yield f"{access[1]}{checked[pointer]}{access[4]}"
                continue
            if steps := STEPPING.match(row):
                yield self._check_steps(steps, self._number(row, tree.For))
                continue
            if division := DIVISION.match(row):
                yield self._check_divisor(division, self._number(row, tree.Binary))
            elif self._shifts and mask and (shift := SHIFT.match(row)) and shift[1] == mask[1]:
                yield f"  call void @bfsim.shifts(i32 {mask[2]}, i64 {self._number(row, Shift)})"
            elif (call := KERNEL_CALL.search(row)) and call[1] in self.routines:
                yield self._note_call(call[1], self._number(row, tree.KernelCall))
            yield row
            yield from pointers.companions(row)
            mask = MASK.match(row)

    def _check_index(self, to: Origin, kind: str, number: int) -> str:
        self._kinds.add(kind)
        values = f"ptr {to.array}, i32 {to.length}, i64 {to.distance}, i64 {number}"
        return f"  %.element.{number} = call ptr @bfsim.element.{kind}({values})"

    def _check_divisor(self, division: re.Match[str], number: int) -> str:
        sign, kind, dividend, divisor = division.groups()
        self._divisions.add((sign, kind))
        values = f"{kind} {dividend}, {kind} {divisor}, i64 {number}"
        return f"  call void @bfsim.divisible.{sign}.{kind}({values})"

    def _check_steps(self, steps: re.Match[str], number: int) -> str:
        self._has_steps = True
        start, stop, step = steps.groups()
        return f"  call void @bfsim.ends(i32 {start}, i32 {stop}, i32 {step}, i64 {number})"

    def _note_call(self, callee: str, number: int) -> str:
        word = CALLS + self.routines.index(callee)
        return f"  store i64 {number}, ptr getelementptr (i64, ptr {self._note}, i64 {word})"

    def _number(self, row: str, node: Node, array: str | None = None) -> int:
        debug = DEBUG.search(row)
        places = self._places.get(debug[1] if debug else "", (SourcePlace(self._routine, 0, 0),))
        self.guards.append(Guard(node, self._routine, places, array))
        return len(self.guards)


def _places(rows: list[str]) -> dict[str, tuple[SourcePlace, ...]]:
    """Return what each debug location of a module means, by its number."""
    scopes = {found[1]: found[2] for found in map(SCOPE.match, rows) if found}
    locations = {found[1]: dict(FIELD.findall(found[2])) for found in map(LOCATION.match, rows) if found}

    def place(fields: dict[str, str]) -> SourcePlace:
        return SourcePlace(scopes[fields["scope"]], int(fields["line"]), int(fields.get("column", 0)))

    found = {}
    for number, fields in locations.items():
        places = [place(fields)]
        while "inlinedAt" in fields:
            fields = locations[fields["inlinedAt"]]  # noqa: PLW2901  # on to where that was inlined
            places.append(place(fields))
        found[number] = tuple(places)
    return found
