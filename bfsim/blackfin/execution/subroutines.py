"""Functions of an image, called as GCC's code calls them (`convention`).

All functions of an image share its memory: one finds what another has left in static variables.
"""

from __future__ import annotations

import mmap
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from bfsim.blackfin.control_flow.convention import KEPT, RESULT, STACK, STACK_BYTES, Contract
from bfsim.blackfin.elf.image import Image
from bfsim.blackfin.execution.address_space import AddressSpace
from bfsim.blackfin.execution.placed import ARRAYS, ARRAYS_BYTES, joined_ranges
from bfsim.blackfin.execution.processor import Processor, Translated
from bfsim.blackfin.instructions.event import Event
from bfsim.blackfin.timing.tables import GNU, Timing
from bfsim.errors import KernelError

if TYPE_CHECKING:
    from bfsim.blackfin.control_flow.blocks import Code
    from bfsim.blackfin.translation.counters import Counted

TRUSTED = Contract(frozenset({RESULT}), is_trusted=True)
CHECKED = Contract(frozenset({RESULT, *KEPT, "FROM"}), is_trusted=False)


@dataclass(eq=False)
class LoadedImage:
    """An image in an address space of its own, with a stack and room for arrays."""

    image: Image
    space: AddressSpace = field(default_factory=AddressSpace)
    _codes: dict[frozenset[int], Code] = field(default_factory=dict)
    _counted: dict[tuple[frozenset[int], str], Counted] = field(default_factory=dict)

    def __post_init__(self) -> None:
        used = [(each.address, each.end) for each in self.image.segments]
        used += [(STACK, STACK + STACK_BYTES), (ARRAYS, ARRAYS + ARRAYS_BYTES)]
        pages = ((low & -mmap.PAGESIZE, -(-high // mmap.PAGESIZE) * mmap.PAGESIZE) for low, high in used)
        for first, end in joined_ranges(pages):
            self.space.add(first, end - first)
        for each in self.image.segments:
            self.space.at(each.address, len(each.octets))[:] = np.frombuffer(each.octets, np.uint8)

    def anew(self) -> LoadedImage:
        """Return the image in another address space, with its variables at their first values."""
        return LoadedImage(self.image, _codes=self._codes, _counted=self._counted)

    def subroutine(
        self, symbol: str, timing: Timing = GNU, name: str = "", *, is_checked: bool = False
    ) -> Subroutine:
        """Return the function called `symbol`; its native code is kept under `name`. Raises KernelError if there is none.

        `is_checked`: misaligned accesses are refused, and it must leave its caller's registers as they were.
        """
        address = self.image.address_of(symbol)
        processor = Processor(
            self.space,
            timing,
            {address},
            name=name,
            explore=partial(self._counted_from, timing),
            contract=CHECKED if is_checked else TRUSTED,
        )
        return Subroutine(symbol, address, processor, self.image)

    def explored(self, *first: int) -> Code:
        """Return the code that is entered at `first`, which is explored once."""
        key = frozenset(first)
        if key not in self._codes:
            self._codes[key] = self._explored(key)
        return self._codes[key]

    def _explored(self, first: frozenset[int]) -> Code:
        """Find the code that is entered at `first`, at targets of its switches, and at functions called by address."""
        from bfsim.blackfin.control_flow.blocks import Code  # most starts explore no code
        from bfsim.blackfin.control_flow.callees import callees

        entries, called = first, frozenset[int]()
        while True:
            code = Code(self.space.fetch, entries, resumes=False, callees=called)
            reached = {self.image.routine_at(each) for each in code.blocks} - {None}
            labels = {each for each in self.image.pointers if self.image.routine_at(each) in reached}
            found = frozenset(callees(code, self.image))
            if labels | found <= entries and found == called:
                return code
            entries, called = entries | labels | found, found

    def _counted_from(self, timing: Timing, first: frozenset[int]) -> Counted:
        """Return the code that is entered at `first` with its counters, which reports of accesses do not change."""
        key = first, timing.digest
        if key not in self._counted:
            from bfsim.blackfin.translation.counters import Counted

            self._counted[key] = Counted(self.explored(*first), timing)
        return self._counted[key]


@dataclass(frozen=True, slots=True)
class Subroutine:
    """A function that can be called."""

    symbol: str
    address: int
    processor: Processor
    image: Image

    @property
    def translated(self) -> Translated:
        """Its native code, with all that it calls."""
        return self.processor.prepared()

    def refuse(self, event: Event) -> NoReturn:
        """Raise KernelError for an event that ended a call before it returned. The next call begins anew."""
        from bfsim.blackfin.execution.failed_call import FailedCall  # few calls fail

        what = FailedCall(self.image, self.processor, self.symbol, event).told()
        self.processor.state.slots[:] = 0
        raise KernelError(f"{self.symbol} must run and return to its caller, but {what}")
