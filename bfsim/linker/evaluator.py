"""Gives the small parts of an LDF their values: object lists, memory segments, and numbers known as they are read.

Works bottom up and in the order of the file, so a use before the definition is an error, as it is for the
linker of VisualDSP++.
"""

from __future__ import annotations

from bisect import bisect, insort
from dataclasses import dataclass
from operator import attrgetter

from lark import Token, v_args

from bfsim.errors import LinkError, cut
from bfsim.linker.expression_builder import ExpressionBuilder
from bfsim.linker.expressions import Expression, ExpressionError
from bfsim.linker.script import (
    COMMAND_LINE_OBJECTS,
    MEMORY_FUNCTIONS,
    LinkerScript,
    Segment,
    memory_function,
)
from bfsim.linker.source import LdfLine, Source

ADDRESSES = range(1 << 32)
"""Those of a Blackfin: with one digit too many, a segment would have gigabytes that no chip has."""

Files = frozenset[str]
_start = attrgetter("start")


@dataclass(frozen=True, slots=True)
class Bound:
    """One of START, END, LENGTH and WIDTH of a segment."""

    keyword: Token
    value: int


@dataclass(frozen=True, slots=True)
class ObjectList:
    """A $LIST: its files, and by name the lists in it that are defined only after it."""

    files: Files
    later: dict[str, Token]


@v_args(inline=True)
class Evaluator(ExpressionBuilder[LinkerScript]):
    """One method per rule of ldf.lark; raises LinkError at the first part that has no value."""

    def __init__(self, source: Source) -> None:
        super().__init__()
        self._source = source
        self._processor = ""
        self._segments: dict[tuple[str, str], Segment] = {}  # by processor (or "") and name in the LDF
        self._by_address: dict[str, list[Segment]] = {}  # the same, by processor
        self._names: set[str] = set()
        self._constants: dict[str, int] = {}
        self._lists = {COMMAND_LINE_OBJECTS: ObjectList(frozenset({COMMAND_LINE_OBJECTS}), {})}

    def _error(self, token: Token, problem: str) -> LinkError:
        return self._source.error_at(token.start_pos or 0, problem)

    def _place(self, token: Token) -> LdfLine:
        return self._source.place_of(token.start_pos or 0)

    def _known_segment(self, name: str, offset: int) -> Segment:
        """Return the segment of a name: the processor's own, else a global one, else another processor's."""
        owners = sorted(self._by_address, key=lambda o: (o != self._processor, o != ""))
        for owner in owners:
            if (owner, name) in self._segments:
                return self._segments[owner, name]
        known = cut(", ".join(segment.name for segment in self._segments.values())) or "none"
        problem = f"segment must be one that MEMORY defines above ({known}), not '{name}'"
        raise self._source.error_at(offset, problem)

    # ---- expressions that must have a value as they are read

    def _value(self, expression: Expression) -> int:
        try:
            return expression.value_in(self)
        except ExpressionError as error:
            raise self._source.error_at(error.offset, error.problem) from None

    def value_of(self, name: str, offset: int) -> int:
        """Return the number that was assigned to a symbol above, outside the output sections."""
        if name not in self._constants:
            problem = f"expression must be made of numbers and #define names, not '{cut(name)}'"
            raise ExpressionError(offset, problem)
        return self._constants[name]

    def result_of(self, function: str, argument: Expression, offset: int) -> int:
        """Return the value of a memory function."""
        if function not in MEMORY_FUNCTIONS:
            known = ", ".join(MEMORY_FUNCTIONS)
            raise ExpressionError(offset, f"function must be one of {known} here, not {function}")
        return memory_function(function, self._known_segment(argument.text, argument.offset))

    # ---- memory segments

    def bound(self, keyword: Token, value: Expression) -> Bound:
        return Bound(keyword, self._value(value))

    def segment(self, name: Token, *bounds: Bound) -> Segment:
        given = {str(bound.keyword): bound.value for bound in bounds}
        if len(given) < len(bounds) or "START" not in given or ("END" in given) == ("LENGTH" in given):
            said = ", ".join(bound.keyword for bound in bounds) or "nothing"
            raise self._error(name, f"segment '{name}' must have one START and one END or LENGTH, not {said}")
        if given.get("WIDTH", 8) != 8:
            raise self._error(
                name, f"segment '{name}' must have WIDTH(8), a Blackfin's, not WIDTH({given['WIDTH']})"
            )
        start = given["START"]
        for keyword in ("START", "END"):
            if given.get(keyword, 0) not in ADDRESSES:
                problem = f"must {keyword} at an address of 32 bits, not at {_address(given[keyword])}"
                raise self._error(name, f"segment '{name}' {problem}")
        if "END" in given and given["END"] < start:
            problem = f"must END at or after its START 0x{start:08X}, not at 0x{given['END']:08X}"
            raise self._error(name, f"segment '{name}' {problem}")
        nbytes = given["LENGTH"] if "LENGTH" in given else given["END"] - start + 1
        if nbytes <= 0 or start + nbytes - 1 not in ADDRESSES:
            problem = f"must have a positive size, and end at an address of 32 bits, not have {nbytes} bytes from 0x{start:08X}"
            raise self._error(name, f"segment '{name}' {problem}")
        segment = Segment(self._place(name), self._unique(name), start, nbytes, self._processor)
        self._check_disjoint(name, segment)
        self._segments[self._processor, str(name)] = segment
        self._names.add(segment.name)
        insort(self._by_address.setdefault(self._processor, []), segment, key=_start)
        return segment

    def _unique(self, name: Token) -> str:
        """Return the name of a segment, with its processor's if another processor has one of that name."""
        return f"{self._processor}.{name}" if name in self._names and self._processor else str(name)

    def _check_disjoint(self, name: Token, segment: Segment) -> None:
        for owner in dict.fromkeys(("", self._processor)):  # each has its own view of the memory they share
            if other := self._segments.get((owner, str(name))):
                where = other.place.beside(segment.place)
                raise self._error(name, f"segment must have a name of its own, not '{name}' of {where}")
            placed = self._by_address.get(owner, [])
            after = bisect(placed, segment.start, key=_start)
            for other in placed[max(0, after - 1) : after + 1]:
                if segment.overlaps(other):
                    place = f"{other.place.beside(segment.place)}, 0x{other.start:08X}-0x{other.end:08X}"
                    problem = f"must not overlap '{other.name}' of {place}"
                    span = f"0x{segment.start:08X}-0x{segment.end:08X}"
                    raise self._error(name, f"segment '{name}', {span}, {problem}")

    # ---- object lists

    def file(self, name: Token, is_taken: bool | None) -> Files:
        return frozenset() if is_taken is False else frozenset({name.strip('"')})

    def members(self, _library: Token, *members: Token) -> Files:
        return frozenset(member.strip('"') for member in members)

    def listed(self, name: Token, is_taken: bool | None) -> Files | Token:
        return frozenset() if is_taken is False else name

    def object_list(self, name: Token, *parts: Files | Token) -> None:
        """Keep a list; other lists in it may be defined below it, as in LDFs of VisualDSP++'s wizard."""
        files, later = frozenset[str](), dict[str, Token]()
        for part in parts:
            if not isinstance(part, Token):
                files |= part
            elif part in self._lists:
                files |= self._lists[part].files
                later |= self._lists[part].later
            elif part == name:
                raise self._undefined(part)
            else:
                later[str(part)] = part
        self._lists[str(name)] = ObjectList(files, later)

    def _files_of(self, part: Files | Token) -> Files:
        """Return the files of an input: its own, or those of a list and of all lists in it."""
        if not isinstance(part, Token):
            return part
        files, waiting, done = frozenset[str](), {str(part): part}, set[str]()
        while waiting:
            name, token = waiting.popitem()
            if name not in self._lists:
                raise self._undefined(token)
            done.add(name)
            files |= self._lists[name].files
            waiting |= {each: at for each, at in self._lists[name].later.items() if each not in done}
        return files

    def _undefined(self, name: Token) -> LinkError:
        known = cut(", ".join(self._lists))
        return self._error(name, f"object list must be one that the LDF defines ({known}), not {cut(name)}")

    def attribute(self) -> bool:
        """Return the value of a test such as prefersMem("internal"): no object file of bfsim has such attributes."""
        return False

    def negation(self, operand: bool) -> bool:
        return not operand

    def both(self, left: bool, right: bool) -> bool:
        return left and right

    def either(self, left: bool, right: bool) -> bool:
        return left or right


def _address(value: int) -> str:
    """Return an address as messages show it, also a negative one."""
    return f"{'-' * (value < 0)}0x{abs(value):08X}"
