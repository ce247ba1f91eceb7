"""Source lines of code: what DWARF says of each address."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from elftools.dwarf.ranges import BaseAddressEntry

from bfsim.blackfin.elf.image import Image
from bfsim.blackfin.elf.units import Unit, read_units


class Line(NamedTuple):
    """A line of a source file, with the file's name as the compiler was given it; 0 if the compiler knows none."""

    file: str
    line: int


class InlinedCall(NamedTuple):
    """From `begin` up to `end`, the code is that of a function called in `line`, in place of the call."""

    begin: int
    end: int
    line: Line


@dataclass(frozen=True, slots=True)
class Row:
    """From `address` on, code comes from `line`; from no line after the end of a function."""

    address: int
    line: Line | None


@dataclass(frozen=True)
class LineTable:
    """Rows by address. Empty for code without debugging information."""

    rows: tuple[Row, ...]

    @cached_property
    def _addresses(self) -> list[int]:
        return [each.address for each in self.rows]

    def at(self, address: int) -> Line | None:
        """Return the line of the code at an address, or None if nothing is known."""
        number = bisect_right(self._addresses, address)
        return self.rows[number - 1].line if number else None


def lines_of(image: Image) -> LineTable:
    """Read the lines of an image. Raises KernelError if its debugging information is damaged."""
    found = sorted(read_units(image, _rows), key=lambda each: (each.address, each.line is not None))
    last = {each.address: each for each in found}
    return LineTable(tuple(last.values()))


def calls_inlined_in(image: Image) -> tuple[InlinedCall, ...]:
    """Return the calls in an image that the compiler has inlined, the innermost first.

    Raises KernelError if its debugging information is damaged.
    """
    return tuple(sorted(read_units(image, _inlined), key=lambda each: each.end - each.begin))


def _inlined(unit: Unit) -> Iterator[InlinedCall]:
    for entry in unit.unit.iter_DIEs():
        if entry.tag == "DW_TAG_inlined_subroutine":
            values = {name: each.value for name, each in entry.attributes.items()}
            line = Line(unit.files[values["DW_AT_call_file"]], values["DW_AT_call_line"])
            for begin, end in _ranges(unit.dwarf, unit.unit, entry, values):
                yield InlinedCall(begin, end, line)


def _ranges(dwarf: Any, unit: Any, entry: Any, values: Mapping[str, int]) -> Iterator[tuple[int, int]]:
    """Yield the ranges of an entry's code, each from an address up to another one."""
    if "DW_AT_low_pc" in values:
        begin, length = values["DW_AT_low_pc"], values["DW_AT_high_pc"]
        yield begin, length if entry.attributes["DW_AT_high_pc"].form == "DW_FORM_addr" else begin + length
    elif "DW_AT_ranges" in values:
        top = unit.get_top_DIE().attributes
        base = top["DW_AT_low_pc"].value if "DW_AT_low_pc" in top else 0
        for each in dwarf.range_lists().get_range_list_at_offset(values["DW_AT_ranges"], cu=unit):
            if isinstance(each, BaseAddressEntry):
                base = each.base_address
            else:
                start = 0 if each.is_absolute else base
                yield start + each.begin_offset, start + each.end_offset


def _rows(unit: Unit) -> Iterator[Row]:
    for entry in unit.program.get_entries():
        state = entry.state
        if state is not None:
            line = None if state.end_sequence else Line(unit.files[state.file], state.line)
            yield Row(state.address, line)
