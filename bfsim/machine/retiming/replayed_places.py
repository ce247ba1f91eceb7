"""Places of recorded work, which names memory by owner, in the memory of the board that plays it."""

from __future__ import annotations

import numpy as np

from bfsim.kernel.types import Number, u8
from bfsim.machine.bus.memory_owners import MemoryOwners
from bfsim.machine.memories import Memories, Row
from bfsim.machine.retiming.work import Place


class ReplayedPlaces:
    """Finds places in memory. `firsts` is where the memory of each owner begins."""

    def __init__(self, owners: MemoryOwners, memories: Memories) -> None:
        self.firsts = np.array(owners.first, np.int64)
        self._owners = owners
        self._memories = memories

    def offset(self, place: Place) -> int:
        """Return the first byte of a place."""
        return int(self.firsts[place.owner]) + place.first

    def row(self, place: Place, element: Number = u8) -> Row:
        """Return the row at a place, with elements of a kind."""
        owner = self._owners[place.owner]
        array = self._memories.bytes_from(self.offset(place), place.nbytes).view(element.dtype)
        return Row(owner.buffer, owner.memory, 0, self.offset(place), array)
