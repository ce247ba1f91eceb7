"""A program in the Blackfin's memory: what lies where, under which names."""

from __future__ import annotations

import hashlib
import json
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import astuple, dataclass, field
from enum import StrEnum
from functools import cached_property

from bfsim.errors import KernelError, cut, listed

MOST_NAMES = 5
"""The most names that an error lists."""
LINKED_WITH = "bfin-elf-gcc -O2 -g -r -nostdlib -o whole.o FILES -lm -lc -lgcc"
"""Makes one object file of several, in C or object code, and of the parts of the libraries that they call."""
LINKED_FROM = (
    "bfin-elf-gcc -r -nostdlib -o whole.o -Wl,--whole-archive {} -Wl,--no-whole-archive -lm -lc -lgcc"
)
"""The same of all object files in an archive."""
NOWHERE, REGISTERS = 0xFFB80000, 0xFFC00000
"""[HRM] A reserved range between the scratchpad and the memory-mapped registers, which holds nothing, not even of a
program; and where these registers begin."""
NOWHERE_BYTES = 256
"""[ours] From one missing symbol to the next."""


class Use(StrEnum):
    """What a section holds."""

    CODE = "code"
    DATA = "data"
    NOTES = "notes"
    """Nothing for the processor, such as debugging information."""


@dataclass(frozen=True, slots=True)
class Segment:
    """Bytes from an address on: code, or data."""

    address: int
    octets: bytes
    use: Use

    @property
    def end(self) -> int:
        """The address after it."""
        return self.address + len(self.octets)


@dataclass(frozen=True, slots=True)
class Routine:
    """A function in an image: from its first address to the one after it."""

    name: str
    address: int
    end: int


@dataclass(frozen=True)
class Image:
    """A program in memory: its segments, addresses by symbol, its functions in the order of their addresses.

    `pointers`: addresses of code that its data holds, such as those of a switch; for a linked program, all words that
    may be such. `octets`: the file with its relocations applied, for readers of debugging information. `missing`:
    symbols that it uses and does not have, by addresses where nothing is.
    """

    name: str
    segments: tuple[Segment, ...]
    symbols: Mapping[str, int]
    routines: tuple[Routine, ...]
    pointers: frozenset[int]
    octets: bytes
    missing: Mapping[int, str] = field(default_factory=dict)

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the file."""
        return hashlib.sha256(self.octets).hexdigest()

    @cached_property
    def code_digest(self) -> str:
        """SHA-256 of what lies in memory, by addresses: it does not depend on the folder where the file was compiled."""
        found = hashlib.sha256()
        for each in self.segments:
            found.update(f"{each.address} {len(each.octets)} {each.use}\n".encode())
            found.update(each.octets)
        return found.hexdigest()

    def octets_of(self, first: int, end: int) -> bytes:
        """Return the bytes of a range of addresses, as far as one segment has them."""
        for each in self.segments:
            if each.address <= first < each.end:
                return each.octets[first - each.address : end - each.address]
        return b""

    def is_code(self, address: int) -> bool:
        """Whether code is at an address."""
        return any(each.use is Use.CODE and each.address <= address < each.end for each in self.segments)

    def routine_at(self, address: int) -> Routine | None:
        """Return the function that an address is in, or None outside all."""
        number = bisect_right(self.routines, address, key=lambda each: each.address)
        found = self.routines[number - 1] if number else None
        return found if found and address < found.end else None

    def missing_at(self, address: int) -> str | None:
        """Return the missing symbol that an address stands for, or None for any other address."""
        return self.missing.get(address - address % NOWHERE_BYTES)

    def address_of(self, symbol: str) -> int:
        """Return the address of a symbol. Raises KernelError if there is none of that name."""
        if symbol not in self.symbols:
            names = listed([cut(each.name) for each in self.routines], MOST_NAMES)
            has = f"only {names}" if names else "no function"
            raise KernelError(f"{self.name} must define {cut(symbol)}, but has {has}")
        return self.symbols[symbol]


def packed(image: Image) -> bytes:
    """Return an image as bytes: a line of JSON, then the contents of its segments and the file."""
    segments = [(each.address, len(each.octets), each.use) for each in image.segments]
    routines = [astuple(each) for each in image.routines]
    missing = sorted(image.missing.items())
    head = json.dumps([image.name, segments, image.symbols, routines, sorted(image.pointers), missing])
    return b"".join((head.encode(), b"\n", *(each.octets for each in image.segments), image.octets))


def unpacked(octets: bytes) -> Image:
    """Return the image that `packed` has turned into bytes."""
    head, _, rest = octets.partition(b"\n")
    name, rows, symbols, routines, pointers, missing = json.loads(head)
    segments = []
    for address, nbytes, use in rows:
        segments.append(Segment(address, rest[:nbytes], Use(use)))
        rest = rest[nbytes:]
    return Image(
        name,
        tuple(segments),
        symbols,
        tuple(Routine(*each) for each in routines),
        frozenset(pointers),
        rest,
        dict(missing),
    )
