"""Functions of an image, called as GCC's code calls them: arguments in R0 to R2 and on the stack, the result in R0.

[GCC] The caller leaves room for the three registers below the arguments on the stack. All functions of an image share its memory:
what one leaves in its static variables another one finds.
"""

from __future__ import annotations

import ctypes
import mmap
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.blackfin.address_space import AddressSpace
from bfsim.blackfin.blocks import Code
from bfsim.blackfin.decode import InstructionError
from bfsim.blackfin.effects import Event
from bfsim.blackfin.linking import ADDRESSES, Image
from bfsim.blackfin.processor import OUTSIDE, AccessError, Processor, Translated
from bfsim.blackfin.timing import GNU, Timing
from bfsim.errors import KernelError

Octets = NDArray[np.uint8]

STACK, STACK_BYTES = 0xFFB00000, 4096
"""[HRM] The scratchpad memory of a core."""
ARRAYS, ARRAYS_BYTES = 0x20000000, 64 << 20
"""[HRM] Asynchronous memory, which programs are not linked to: where arrays are laid."""
ARRAY_ALIGN = 32
WORD_BYTES = 4
REGISTERS = ("R0", "R1", "R2")
M32 = 0xFFFFFFFF


@dataclass(frozen=True, slots=True)
class Returned:
    """What a call left: R0, and the core clock cycles that it took, from its first instruction to its return."""

    value: int
    cclk: int


@dataclass
class LoadedImage:
    """An image in an address space of its own, with a stack and room for arrays."""

    image: Image
    space: AddressSpace = field(default_factory=AddressSpace)

    def __post_init__(self) -> None:
        used = [(each.address, each.end) for each in self.image.segments]
        used += [(STACK, STACK + STACK_BYTES), (ARRAYS, ARRAYS + ARRAYS_BYTES)]
        pages = ((low & -mmap.PAGESIZE, -(-high // mmap.PAGESIZE) * mmap.PAGESIZE) for low, high in used)
        for first, end in _joined(pages):
            self.space.add(first, end - first)
        for each in self.image.segments:
            self.space.at(each.address, len(each.octets))[:] = np.frombuffer(each.octets, np.uint8)

    def subroutine(self, symbol: str, timing: Timing = GNU) -> Subroutine:
        """Return the function called `symbol`. Raises KernelError if there is none."""
        address = self.image.address_of(symbol)
        return Subroutine(symbol, address, Processor(self.space, timing, self._entries(address)))

    def _entries(self, address: int) -> set[int]:
        """Where code can be entered that starts at an address: there, and where the switches of its functions lead to."""
        entries, found = set[int](), {address}
        while not found <= entries:
            entries |= found
            reached = {
                self.image.routine_at(each) for each in Code(self.space.fetch, frozenset(entries)).blocks
            }
            found = {each for each in self.image.pointers if self.image.routine_at(each) in reached - {None}}
        return entries


@dataclass(frozen=True, slots=True)
class Subroutine:
    """A function that can be called."""

    symbol: str
    address: int
    processor: Processor

    @property
    def translated(self) -> Translated:
        """Its native code, with all that it calls."""
        return self.processor.prepared()

    def take_counts(self) -> NDArray[np.int64]:
        """Return what its counters have counted since this was asked last."""
        counts = self.translated.counts.copy()
        self.translated.counts[:] = 0
        return counts

    def call(self, words: Sequence[int]) -> Returned:
        """Call it with arguments of 32 bits. Raises KernelError where it does anything else than to return."""
        state, space = self.processor.state, self.processor.space
        room = WORD_BYTES * max(len(REGISTERS), len(words))
        top = STACK + STACK_BYTES - room
        for register, word in zip(REGISTERS, words, strict=False):
            state[register] = word & M32
        beyond = [each & M32 for each in words[len(REGISTERS) :]]
        first = top + WORD_BYTES * len(REGISTERS)
        space.at(first, WORD_BYTES * len(beyond)).view("<u4")[:] = beyond
        state["SP"], state["FP"], state["CLOCK"] = top, 0, 0
        known = self.translated
        try:
            event = self.processor.call(self.address)
        except (AccessError, InstructionError) as error:
            raise KernelError(f"{self.symbol} failed: {error}") from None
        if self.translated is not known:
            raise KernelError(
                f"{self.symbol} must jump only where its code and the words of its data say, but it computed another address; "
                "then its counters are not known before it runs"
            )
        if event is not Event.UNKNOWN_TARGET or state["PC"] != OUTSIDE:
            raise KernelError(
                f"{self.symbol} must return to its caller, but at 0x{state['PC']:08X} there is {event.name.lower()}"
            )
        return Returned(state["R0"], state["CLOCK"])


@dataclass(frozen=True, slots=True)
class Placed:
    """Memory of the host that has a copy in the Blackfin's while a function runs. What is not writeable is not copied back."""

    octets: Octets
    copy: Octets
    is_writeable: bool

    def bring(self) -> None:
        """Copy it to the Blackfin's memory."""
        self.copy[:] = self.octets

    def fetch(self) -> None:
        """Copy it back."""
        if self.is_writeable:
            self.octets[:] = self.copy


def placed(arrays: Sequence[NDArray[Any]], space: AddressSpace) -> tuple[list[Placed], list[int]]:
    """Give arrays places in the Blackfin's memory; return those and the address of each array. What overlaps here does so there.

    Raises KernelError if there is no room for them.
    """
    ranges = [(each.ctypes.data, each.ctypes.data + each.nbytes) for each in arrays]
    parts: list[Placed] = []
    address, starts = ARRAYS, []
    for low, high in _joined(ranges):
        address = -(-address // ARRAY_ALIGN) * ARRAY_ALIGN + low % ARRAY_ALIGN
        nbytes = high - low
        if address + nbytes > ARRAYS + ARRAYS_BYTES:
            raise KernelError(f"the arrays of a call must fit into {ARRAYS_BYTES:,} bytes, but do not")
        octets = np.ctypeslib.as_array((ctypes.c_uint8 * nbytes).from_address(low))
        within = (each for each, (first, _) in zip(arrays, ranges, strict=True) if low <= first < high)
        parts.append(Placed(octets, space.at(address, nbytes), all(each.flags.writeable for each in within)))
        starts.append((low, address))
        address += nbytes
    addresses = []
    for low, _ in ranges:
        start, at = starts[bisect_right(starts, (low, ADDRESSES)) - 1]
        addresses.append(at + low - start)
    return parts, addresses


def _joined(ranges: Iterable[tuple[int, int]]) -> Iterator[tuple[int, int]]:
    """Ranges in their order, those that overlap or meet as one."""
    first, end = None, 0
    for low, high in sorted(ranges):
        if first is not None and low <= end:
            end = max(end, high)
            continue
        if first is not None:
            yield first, end
        first, end = low, high
    if first is not None:
        yield first, end
