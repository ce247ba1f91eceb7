"""Gives the small parts of an LDF their values: object lists, memory segments, and numbers known as they are read.

Works bottom up and in the order of the file, so a use before the definition is an error, as it is for the
linker of VisualDSP++.
"""

from __future__ import annotations

from dataclasses import dataclass

from lark import Token, v_args

from bfsim.errors import LinkError
from bfsim.linker.expression_builder import ExpressionBuilder
from bfsim.linker.expressions import Expression, ExpressionError
from bfsim.linker.script import (
    COMMAND_LINE_OBJECTS,
    MEMORY_FUNCTIONS,
    LinkerScript,
    Segment,
    memory_function,
)
from bfsim.linker.source import Place, Source

Files = frozenset[str]


@dataclass(frozen=True, slots=True)
class Bound:
    """One of START, END, LENGTH and WIDTH of a segment."""

    keyword: Token
    value: int


@v_args(inline=True)
class Evaluator(ExpressionBuilder[LinkerScript]):
    """One method per rule of ldf.lark; raises LinkError at the first part that has no value."""

    def __init__(self, source: Source) -> None:
        super().__init__()
        self._source = source
        self._processor = ""
        self._segments: dict[tuple[str, str], Segment] = {}  # by processor (or "") and name in the LDF
        self._constants: dict[str, int] = {}
        self._lists: dict[str, Files] = {COMMAND_LINE_OBJECTS: frozenset({COMMAND_LINE_OBJECTS})}

    def _error(self, token: Token, problem: str) -> LinkError:
        return self._source.error_at(token.start_pos or 0, problem)

    def _place(self, token: Token) -> Place:
        return self._source.place_of(token.start_pos or 0)

    def _known_segment(self, name: str, offset: int) -> Segment:
        """Return the segment of a name: the processor's own, a global one, else another processor's."""
        owners = sorted(
            dict.fromkeys(owner for owner, _ in self._segments), key=lambda o: (o != self._processor, o != "")
        )
        for owner in owners:
            if (owner, name) in self._segments:
                return self._segments[owner, name]
        known = ", ".join(segment.name for segment in self._segments.values()) or "none"
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
            problem = f"expression must be made of numbers and #define names, not '{name}'"
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
        if "END" in given and given["END"] < start:
            problem = f"must END at or after its START 0x{start:08X}, not at 0x{given['END']:08X}"
            raise self._error(name, f"segment '{name}' {problem}")
        nbytes = given["LENGTH"] if "LENGTH" in given else given["END"] - start + 1
        if start < 0 or nbytes <= 0:
            problem = f"must have a positive size from a positive address, not {nbytes} bytes from {start}"
            raise self._error(name, f"segment '{name}' {problem}")
        segment = Segment(self._place(name), self._unique(name), start, nbytes, self._processor)
        self._check_disjoint(name, segment)
        self._segments[self._processor, str(name)] = segment
        return segment

    def _unique(self, name: Token) -> str:
        """Return the name of a segment, with its processor's if another processor has one of that name."""
        is_taken = any(name == segment.name for segment in self._segments.values())
        return f"{self._processor}.{name}" if is_taken and self._processor else str(name)

    def _check_disjoint(self, name: Token, segment: Segment) -> None:
        for (owner, known), other in self._segments.items():
            if owner not in ("", self._processor):
                continue  # each processor has its own view of the memory they share
            if known == name:
                where = other.place.beside(segment.place)
                raise self._error(name, f"segment must have a name of its own, not '{name}' of {where}")
            if segment.overlaps(other):
                place = f"{other.place.beside(segment.place)}, 0x{other.start:08X}-0x{other.end:08X}"
                problem = f"must not overlap '{known}' of {place}"
                raise self._error(
                    name, f"segment '{name}', 0x{segment.start:08X}-0x{segment.end:08X}, {problem}"
                )

    # ---- object lists

    def file(self, name: Token, is_taken: bool | None) -> Files:
        return frozenset() if is_taken is False else frozenset({name.strip('"')})

    def members(self, _library: Token, *members: Token) -> Files:
        return frozenset(member.strip('"') for member in members)

    def listed(self, name: Token, is_taken: bool | None) -> Files:
        if name not in self._lists:
            known = ", ".join(self._lists)
            raise self._error(name, f"object list must be one that is defined above ({known}), not {name}")
        return frozenset() if is_taken is False else self._lists[name]

    def object_list(self, name: Token, *parts: Files) -> None:
        self._lists[str(name)] = frozenset().union(*parts)

    def attribute(self) -> bool:
        """Value of a test such as prefersMem("internal"): no object file of bfsim carries such attributes."""
        return False

    def negation(self, operand: bool) -> bool:
        return not operand

    def both(self, left: bool, right: bool) -> bool:
        return left and right

    def either(self, left: bool, right: bool) -> bool:
        return left or right
