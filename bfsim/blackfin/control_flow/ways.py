"""The paths of calls through the code of a function, in words: which function calls which, in which source lines."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

from bfsim.blackfin.control_flow.blocks import COMPUTED, DIRECT, Code, does
from bfsim.blackfin.control_flow.callees import callees
from bfsim.blackfin.elf.image import Image
from bfsim.blackfin.elf.lines import LineTable
from bfsim.errors import cut, listed

MOST_LINES, MOST_CALLS = 3, 4
"""[ours] The most lines with the same call that are listed, and the most calls of a path: the last ones."""
CALLS, MAY_CALL = "calls", "may call by its address"


@dataclass(frozen=True)
class Ways:
    """The paths to everything that the code of `entry`, a symbol, has or calls."""

    image: Image
    code: Code
    lines: LineTable
    entry: str

    @cached_property
    def _sources(self) -> Mapping[int, list[int]]:
        """For each address, the instructions that go straight there from another function."""
        found: dict[int, list[int]] = {}
        for block in self.code.blocks.values():
            last = block.instructions[-1] if block.instructions else None
            if last and does(last) in DIRECT:
                target = int(last.operations[0].operands["t"])
                if self._function(target) != self._function(last.address):
                    found.setdefault(target, []).append(last.address)
        return found

    @cached_property
    def _computed(self) -> list[int]:
        """The instructions that go to a computed address."""
        lasts = [
            each.instructions[-1]
            for each in self.code.blocks.values()
            if each.instructions and not each.returns
        ]
        return [each.address for each in lasts if does(each) in COMPUTED]

    @cached_property
    def _by_address(self) -> set[int]:
        """The beginnings of functions that these may go to."""
        return callees(self.code, self.image)

    def line_at(self, address: int) -> str:
        """Return the source line of the code at an address, as `file:line`; '' if the image does not tell."""
        found = self.lines.at(address)
        return f"{cut(found.file)}:{found.line}" if found and found.line else ""

    def place(self, address: int) -> str:
        """Return where the code at an address is, and who calls it: `at 0xFFA00000 (memcpy.c:80) of memcpy, which f calls at f.c:3,`."""
        line, function = self.line_at(address), self._function(address)
        place = f"at 0x{address:08X}{line and f' ({line})'}"
        routine = self.image.routine_at(address)
        if function == self.entry or routine is None:
            return place
        callers = self.callers(*self._calling(routine.address))
        return f"{place} of {cut(_name(function))}{callers and f', which {callers}'},"

    def going_to(self, address: int) -> list[int]:
        """Return the instructions that go straight to an address from another function."""
        return self._sources.get(address, [])

    def _calling(self, address: int) -> tuple[list[int], str]:
        """Return the instructions that go straight to a function, or else those that may go there; and the verb for that."""
        straight = self.going_to(address)
        if straight or address not in self._by_address:
            return straight, CALLS
        return self._computed, MAY_CALL

    def callers(self, places: Iterable[int], verb: str = CALLS) -> str:
        """Return who calls, or uses, something at places, by the shortest path: `exit calls at exit.c:64, which f calls at f.c:3`."""
        told = []
        for function, found, does_so in self._way(tuple(places), verb):
            named = list(dict.fromkeys(self.line_at(each) or f"0x{each:08X}" for each in found))
            told.append(f"{cut(_name(function))} {does_so} at {listed(named, MOST_LINES)}")
        hidden = len(told) - MOST_CALLS
        if hidden > 1:
            told[MOST_CALLS - 1 : -1] = [f"{hidden} more call in turn"]
        return ", which ".join(told)

    def _way(self, places: tuple[int, ...], verb: str) -> list[tuple[str, list[int], str]]:
        """Return the functions on the shortest path from places to the entry, each with its places; the first if none."""
        first = [[(*each, verb)] for each in self._by_function(places).items()]
        waiting, seen = list(first), {each[-1][0] for each in first}
        for way in waiting:
            function = way[-1][0]
            if function == self.entry:
                return way
            sources, how = self._calling(self.image.symbols.get(function, -1))
            for caller, found in self._by_function(sources).items():
                if caller not in seen:
                    seen.add(caller)
                    waiting.append([*way, (caller, found, how)])
        return first[0] if first else []

    def _by_function(self, places: Iterable[int]) -> dict[str, list[int]]:
        found: dict[str, list[int]] = {}
        for each in sorted(places):
            found.setdefault(self._function(each), []).append(each)
        return found

    def _function(self, address: int) -> str:
        """Return the symbol of the function that has the code at an address; a made-up one if it is missing or has no name."""
        routine = self.image.routine_at(address)
        return routine.name if routine else f"0x{address:08X}"


def _name(symbol: str) -> str:
    """Return what C calls a symbol."""
    return symbol.removeprefix("_")
