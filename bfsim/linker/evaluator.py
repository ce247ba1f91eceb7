"""Gives the small parts of an LDF their values: expressions, object lists and memory segments.

Works bottom up and in the order of the file, so a use before the definition is an error, as it is for the
linker of VisualDSP++.
"""

from __future__ import annotations

from dataclasses import dataclass

from lark import Token, v_args
from lark.visitors import Transformer_NonRecursive

from bfsim.errors import LinkError
from bfsim.linker.script import COMMAND_LINE_OBJECTS, LinkerScript, Segment
from bfsim.linker.source import Source

_SUFFIXES = {"K": 1024, "M": 1024 * 1024}


@dataclass(frozen=True, slots=True)
class Bound:
    """One of START, END, LENGTH and WIDTH of a segment."""

    keyword: Token
    value: int


@v_args(inline=True)
class Evaluator(Transformer_NonRecursive[Token, LinkerScript]):
    """One method per rule of ldf.lark; raises LinkError at the first part that has no value."""

    def __init__(self, source: Source) -> None:
        super().__init__()
        self._source = source
        self._segments: dict[str, Segment] = {}
        self._lists: dict[str, frozenset[str]] = {COMMAND_LINE_OBJECTS: frozenset({COMMAND_LINE_OBJECTS})}

    def _error(self, token: Token, problem: str) -> LinkError:
        return self._source.error_at(token.start_pos or 0, problem)

    def _line(self, token: Token) -> int:
        return self._source.line_at(token.start_pos or 0)

    def _known_segment(self, name: Token) -> Segment:
        if name not in self._segments:
            known = ", ".join(self._segments) or "none"
            raise self._error(name, f"segment must be one that MEMORY defines above ({known}), not '{name}'")
        return self._segments[name]

    # ---- memory segments

    def bound(self, keyword: Token, value: int) -> Bound:
        return Bound(keyword, value)

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
        segment = Segment(str(name), start, nbytes, self._line(name))
        self._check_disjoint(name, segment)
        self._segments[segment.name] = segment
        return segment

    def _check_disjoint(self, name: Token, segment: Segment) -> None:
        for other in self._segments.values():
            if other.name == segment.name:
                raise self._error(
                    name, f"segment must have a name of its own, not '{name}' of line {other.line}"
                )
            if segment.start < other.start + other.nbytes and other.start < segment.start + segment.nbytes:
                place = f"line {other.line}, 0x{other.start:08X}-0x{other.end:08X}"
                problem = f"must not overlap '{other.name}' of {place}"
                raise self._error(
                    name, f"segment '{name}', 0x{segment.start:08X}-0x{segment.end:08X}, {problem}"
                )

    # ---- object lists

    def file(self, name: Token) -> frozenset[str]:
        return frozenset({name.strip('"')})

    def listed(self, name: Token, is_taken: bool | None) -> frozenset[str]:
        if name not in self._lists:
            known = ", ".join(self._lists)
            raise self._error(name, f"object list must be one that is defined above ({known}), not {name}")
        return frozenset() if is_taken is False else self._lists[name]

    def object_list(self, name: Token, *parts: frozenset[str] | None) -> None:
        self._lists[str(name)] = frozenset().union(*(part for part in parts if part is not None))

    def attribute(self) -> bool:
        """Value of a test such as prefersMem("internal"): no object file of bfsim carries such attributes."""
        return False

    def negation(self, operand: bool) -> bool:
        return not operand

    def both(self, left: bool, right: bool) -> bool:
        return left and right

    def either(self, left: bool, right: bool) -> bool:
        return left or right

    # ---- expressions

    def number(self, text: Token) -> int:
        if text[:2] in ("0x", "0X"):
            return int(text, 16)
        return int(text.rstrip("kKmM")) * _SUFFIXES.get(text[-1].upper(), 1)

    def undefined(self, name: Token) -> int:
        raise self._error(name, f"expression must be made of numbers and #define names, not '{name}'")

    def memory_function(self, function: Token, name: Token) -> int:
        segment = self._known_segment(name)
        values = {"MEMORY_START": segment.start, "MEMORY_END": segment.end, "MEMORY_SIZEOF": segment.nbytes}
        return values[function]

    def divide(self, dividend: int, sign: Token, divisor: int) -> int:
        if divisor == 0:
            raise self._error(sign, "divisor must not be 0")
        return dividend // divisor

    def multiply(self, left: int, right: int) -> int:
        return left * right

    def add(self, left: int, right: int) -> int:
        return left + right

    def subtract(self, left: int, right: int) -> int:
        return left - right

    def bit_and(self, left: int, right: int) -> int:
        return left & right

    def bit_or(self, left: int, right: int) -> int:
        return left | right

    def negative(self, operand: int) -> int:
        return -operand

    def inverse(self, operand: int) -> int:
        return ~operand
