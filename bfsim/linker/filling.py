"""A memory segment while it fills: one location pointer, and fixed reserves that it steps over."""

from __future__ import annotations

from collections.abc import Iterable

from bfsim.linker.link_map import SegmentUsage
from bfsim.linker.script import FixedReserve, Segment


class Filling:
    """Hands out the bytes of a segment from its start to its end; what the pointer has passed is used."""

    def __init__(self, segment: Segment, reserves: Iterable[FixedReserve]) -> None:
        self.segment = segment
        self._limit = segment.start + segment.nbytes
        self._pointer = segment.start
        self._reserves = sorted(
            (r for r in reserves if segment.start <= r.start < self._limit),
            key=lambda reserved: reserved.start,
        )

    def address_for(self, nbytes: int, align: int) -> int:
        """Return the first address, maybe beyond the segment, where `nbytes` clear every reserve."""
        address = _align_up(self._pointer, align)
        for reserved in self._reserves:
            if address < reserved.start + reserved.nbytes and reserved.start < address + nbytes:
                address = _align_up(reserved.start + reserved.nbytes, align)
        return address

    def has_room(self, nbytes: int, align: int) -> bool:
        """Say whether `nbytes` still fit."""
        return self.address_for(nbytes, align) + nbytes <= self._limit

    def take(self, nbytes: int, align: int) -> int:
        """Move the pointer behind the next `nbytes` and return their address."""
        address = self.address_for(nbytes, align)
        self._pointer = address + nbytes
        return address

    @property
    def free_bytes(self) -> int:
        """Bytes ahead of the pointer that no fixed reserve takes."""
        ends = ((r.start + r.nbytes, max(r.start, self._pointer)) for r in self._reserves)
        return self._limit - self._pointer - sum(max(0, end - start) for end, start in ends)

    @property
    def usage(self) -> SegmentUsage:
        """How full the segment is now."""
        segment = self.segment
        return SegmentUsage(segment.name, segment.start, segment.nbytes, segment.nbytes - self.free_bytes)


def _align_up(address: int, align: int) -> int:
    return -(-address // align) * align
