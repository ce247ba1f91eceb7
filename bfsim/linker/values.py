"""The symbols that an LDF assigns: computed where they stand if possible, else when everything has its place."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field

from bfsim.linker.expressions import Expression, ExpressionError
from bfsim.linker.filling import align_up
from bfsim.linker.script import MEMORY_FUNCTIONS, Assignment, LinkerScript, memory_function

Key = tuple[str | None, str]  # processor (None: both cores) and name
_FUNCTIONS = (*MEMORY_FUNCTIONS, "SIZEOF", "ADDR", "DEFINED", "ABSOLUTE", "ALIGN")


class _NotYetError(Exception):
    """Raised for a value that is known only when everything has its place, if at all."""


@dataclass(slots=True)
class Values:
    """The values of one link, and the assignments that still wait for theirs, each with its location counter."""

    script: LinkerScript
    known: dict[Key, int] = field(default_factory=dict)
    is_settled: bool = False
    addresses: Mapping[Key, int] = field(default_factory=dict)
    extents: Mapping[Key, tuple[int, int]] = field(default_factory=dict)
    _waiting: list[tuple[str | None, Assignment, int | None]] = field(default_factory=list)
    _waiting_keys: set[Key] = field(default_factory=set)

    def assign(self, processor: str | None, assignment: Assignment, location: int | None = None) -> None:
        """Enter an assignment that stands where the location counter is `location`, if it has one there."""
        key = processor, assignment.symbol
        with suppress(_NotYetError):
            if key not in self._waiting_keys:  # the last assignment to a symbol holds
                self.known[key] = self._compute(processor, assignment.expression, location)
                return
        self.known.pop(key, None)
        self._waiting_keys.add(key)
        self._waiting.append((processor, assignment, location))

    def location_of(self, processor: str | None, assignment: Assignment, location: int) -> int:
        """Return where an assignment to "." moves the location counter; raise LinkError if that is not known yet."""
        try:
            return self._compute(processor, assignment.expression, location)
        except _NotYetError:
            problem = (
                "location counter must be set to what is known there, not to what follows from the placement"
            )
            raise self.script.source.error_at(assignment.expression.offset, problem) from None

    def settle(
        self,
        addresses: Mapping[Key, int],
        extents: Mapping[Key, tuple[int, int]],
        reserved: Mapping[Key, int],
    ) -> Mapping[Key, int]:
        """Return all values, given the addresses of symbols, start and size of output sections, and reserves."""
        self.is_settled, self.addresses, self.extents = True, addresses, extents
        self.known |= reserved
        for processor, assignment, location in self._waiting:
            # What follows from symbols that only C firmware has, such as _main, has no value and moves nothing.
            with suppress(_NotYetError):
                value = self._compute(processor, assignment.expression, location)
                self.known[processor, assignment.symbol] = value
        return self.known

    def _compute(self, processor: str | None, expression: Expression, location: int | None) -> int:
        try:
            return expression.value_in(_Scope(self, processor, location))
        except ExpressionError as error:
            raise self.script.source.error_at(error.offset, error.problem) from None


@dataclass(frozen=True, slots=True)
class _Scope:
    """What names stand for in one assignment."""

    values: Values
    processor: str | None
    location: int | None

    def value_of(self, name: str, offset: int) -> int:
        """Return the location counter, an assigned symbol, a reserve's symbol, or the address of a placed one."""
        if name == ".":
            if self.location is None:
                raise ExpressionError(offset, "location counter must stand inside an output section")
            return self.location
        value = self._find(name)
        if value is None:
            raise _NotYetError
        return value

    def result_of(self, function: str, argument: Expression, offset: int) -> int:
        """Return the value of a function of memories, output sections, symbols or the location counter."""
        if function in ("ABSOLUTE", "ALIGN"):
            value = argument.value_in(self)
            return value if function == "ABSOLUTE" else self._aligned(value, offset)
        if function not in _FUNCTIONS:
            raise ExpressionError(offset, f"function must be one of {', '.join(_FUNCTIONS)}, not {function}")
        if argument.operator != "name":
            raise ExpressionError(argument.offset, f"{function} must be of a name")
        if function in MEMORY_FUNCTIONS:
            return self._memory(function, argument)
        if not self.values.is_settled:
            raise _NotYetError
        if function == "DEFINED":
            return int(self._find(argument.text) is not None)
        for key in self._keys(argument.text):
            if key in self.values.extents:
                return self.values.extents[key][function == "SIZEOF"]
        raise ExpressionError(
            argument.offset, f"output section must be one of the LDF, not '{argument.text}'"
        )

    def _keys(self, name: str) -> Iterable[Key]:
        return (self.processor, name), (None, name)

    def _find(self, name: str) -> int | None:
        keys = self._keys(name)
        found = (
            table[key] for table in (self.values.known, self.values.addresses) for key in keys if key in table
        )
        return next(found, None)

    def _aligned(self, nbytes: int, offset: int) -> int:
        if nbytes < 1 or nbytes & (nbytes - 1):
            raise ExpressionError(offset, f"alignment must be a power of two, not {nbytes}")
        return align_up(self.value_of(".", offset), nbytes)

    def _memory(self, function: str, argument: Expression) -> int:
        segments = self.values.script.segment_by_name
        for name in (f"{self.processor}.{argument.text}", argument.text):
            if name in segments:
                return memory_function(function, segments[name])
        known = ", ".join(segments) or "none"
        raise ExpressionError(
            argument.offset, f"segment must be one of MEMORY ({known}), not '{argument.text}'"
        )
