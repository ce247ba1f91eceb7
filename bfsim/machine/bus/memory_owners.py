"""The owners of memory, for whom data moves: the buffers, and the rest of each memory, which belongs to no buffer."""

from __future__ import annotations

from bisect import bisect_right, insort
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import FirmwareError
from bfsim.kernel.native.entries import native
from bfsim.machine.bus import state as w
from bfsim.machine.bus.core_logs import site_at
from bfsim.machine.bus.state import State


@dataclass(frozen=True, slots=True)
class MemoryOwner:
    """A buffer, by a name unique among all cores. Without `buffer`, the part of `memory` that belongs to none."""

    memory: str
    buffer: str = ""
    nbytes: int = 0


class MemoryOwners:
    """All owners by number. The state `words` of a bus say which piece of the arena belongs to which owner."""

    def __init__(self, words: Any, sdram_end: int, l2_end: int) -> None:
        self._words = words
        self._owners = [MemoryOwner("SDRAM"), MemoryOwner("L2"), MemoryOwner("elsewhere")]
        self._pieces = [(0, w.NO_BUFFER_IN_SDRAM), (sdram_end, w.NO_BUFFER_IN_L2), (l2_end, w.NO_BUFFER)]
        self.first = [0, sdram_end, l2_end]
        """Where in the arena each owner's memory begins, by number."""
        self._write()

    def __len__(self) -> int:
        return len(self._owners)

    def __iter__(self) -> Iterator[MemoryOwner]:
        return iter(self._owners)

    def __getitem__(self, number: int) -> MemoryOwner:
        return self._owners[number]

    def add(self, owner: MemoryOwner, offset: int) -> None:
        """Let a buffer own its bytes from arena offset `offset` on."""
        if len(self._owners) == w.MAX_OWNERS:
            raise FirmwareError(f"firmware must have at most {w.MAX_OWNERS - 3} buffers")
        end, number = offset + owner.nbytes, len(self._owners)
        behind = self.of(end)
        self._pieces = [each for each in self._pieces if not offset <= each[0] <= end]
        insort(self._pieces, (offset, number))
        insort(self._pieces, (end, behind))
        self._owners.append(owner)
        self.first.append(offset)
        self._write()

    def of(self, offset: int) -> int:
        """Return the number of the owner of the byte at `offset`."""
        return self._pieces[bisect_right(self._firsts, offset) - 1][1]

    def of_all(self, offsets: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the numbers of the owners of the bytes at `offsets`."""
        firsts, owners = np.array(self._pieces, np.int64).T
        found: NDArray[np.int64] = owners[np.searchsorted(firsts, offsets, "right") - 1]
        return found

    def _write(self) -> None:
        self._firsts = [offset for offset, _ in self._pieces]
        self._words[w.PIECES] = len(self._pieces)
        for number, (offset, owner) in enumerate(self._pieces):
            self._words[w.PIECES_AT + number] = offset
            self._words[w.PIECES_AT + w.MAX_PIECES + number] = owner
        self._words[w.PIECES_AT + len(self._pieces)] = w.NEVER


@native
def owner_for(state: State, core: int, offset: int, site: int) -> int:
    """Return the owner of the memory that a core's site accesses: no buffer if the access comes from no kernel."""
    if site == w.NO_SITE:
        return w.NO_BUFFER_IN_SDRAM if offset < state[w.SDRAM_END] else w.NO_BUFFER_IN_L2
    return state[w.PIECES_AT + w.MAX_PIECES + piece_for(state, site_at(core, site), offset)]


@native
def piece_for(state: State, row: int, offset: int) -> int:
    """Return the number of the piece of memory around `offset`, and keep it for the site at `row`."""
    piece = state[row + w.PIECE]
    if not state[w.PIECES_AT + piece] <= offset < state[w.PIECES_AT + piece + 1]:
        piece = state[row + w.PIECE] = piece_of(state, offset)
    return piece


@native
def piece_of(state: State, offset: int) -> int:
    """Return the number of the piece of memory around `offset`."""
    low, high = 0, state[w.PIECES] - 1
    while low < high:
        middle = (low + high + 1) >> 1
        if state[w.PIECES_AT + middle] <= offset:
            low = middle
        else:
            high = middle - 1
    return low
