"""The copies of recorded work, planned for the board that plays them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bfsim.errors import WorkError
from bfsim.kernel.calls import access_log as log
from bfsim.machine.bus import state as w
from bfsim.machine.bus.stretch_player import StretchPlayer
from bfsim.machine.dma.mdma import MdmaStream
from bfsim.machine.retiming.replayed_places import ReplayedPlaces
from bfsim.machine.retiming.work import (
    DESTINATION,
    DESTINATION_BYTE,
    NBYTES,
    SOURCE,
    SOURCE_BYTE,
    STREAM,
    Place,
    Table,
)


class ReplayedCopies:
    """The copies of one core on its `streams`. `rows` has the plan's number, source and destination of each copy, as after COPY (`bus.state`)."""

    def __init__(
        self, stretches: StretchPlayer, places: ReplayedPlaces, streams: Sequence[MdmaStream], word_bytes: int
    ) -> None:
        """`word_bytes` is the size of the words that DMA moves."""
        self.rows = np.zeros((0, 3), np.int64)
        self._plans: dict[int, int] = {}  # numbers by kind of copy
        self._stretches = stretches
        self._places = places
        self._streams = streams
        self._word_bytes = word_bytes

    def know(self, copies: Table) -> None:
        """Add copies, numbered after the known ones. Copies of one kind differ only in their places."""
        if not len(copies):
            return  # most frames have no new ones
        owners, word_bytes = copies[:, [SOURCE, DESTINATION]].T, self._word_bytes
        sources, destinations = self._places.firsts[owners] + copies[:, [SOURCE_BYTE, DESTINATION_BYTE]].T
        kinds = copies[:, STREAM]  # with everything else that they have in common, as one number
        for more, room in (
            (owners[0], w.MAX_OWNERS),
            (owners[1], w.MAX_OWNERS),
            (copies[:, NBYTES], log.OFFSET_MASK + 1),
        ):
            kinds = kinds * room + more
        kinds = kinds * word_bytes + (sources | destinations) % word_bytes
        found, examples, kind_of = np.unique(kinds, return_index=True, return_inverse=True)
        for kind, example in zip(found.tolist(), examples.tolist(), strict=True):
            if kind not in self._plans:
                (self._plans[kind],) = self._stretches.keep_plans([self._plan(*copies[example].tolist())])
        plans = np.array([self._plans[each] for each in found.tolist()])
        self.rows = np.concatenate([self.rows, np.stack([plans[kind_of], sources, destinations], axis=1)])

    def _plan(
        self, stream: int, source: int, from_byte: int, destination: int, to_byte: int, nbytes: int
    ) -> tuple[int, ...]:
        rows = (
            self._places.row(Place(source, from_byte, nbytes)),
            self._places.row(Place(destination, to_byte, nbytes)),
        )
        for each in rows:
            if "SCRATCH" in each.memory:
                raise WorkError(f"{each.buffer} must be where DMA can reach it, not in {each.memory}")
        return self._streams[stream].plan(*rows).words
