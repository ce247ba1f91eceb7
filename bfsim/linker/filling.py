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
        # Two processors that share a memory may both reserve the same bytes.
        inside = {(each.start, each.start + each.nbytes) for each in reserves}
        self._reserved = sorted(inside)

    @property
    def location(self) -> int:
        """The location pointer: first address after all that was taken."""
        return self._pointer

    def address_for(self, nbytes: int, align: int) -> int:
        """Return the first address, maybe beyond the segment, where `nbytes` clear every reserve."""
        address = align_up(self._pointer, align)
        for start, end in self._reserved:
            if address < end and start < address + nbytes:
                address = align_up(end, align)
        return address

    def rest_at(self, address: int) -> int:
        """Return how many bytes from `address` on are free in one piece."""
        return min((start for start, _ in self._reserved if start >= address), default=self._limit) - address

    def has_room(self, nbytes: int, align: int) -> bool:
        """Return whether `nbytes` still fit."""
        return self.address_for(nbytes, align) + nbytes <= self._limit

    def take(self, nbytes: int, align: int) -> int:
        """Move the pointer past the next `nbytes` and return their address."""
        address = self.address_for(nbytes, align)
        self._pointer = address + nbytes
        return address

    @property
    def free_bytes(self) -> int:
        """Bytes ahead of the pointer that no fixed reserve takes."""
        ahead = sum(max(0, end - max(start, self._pointer)) for start, end in self._reserved)
        return self._limit - self._pointer - ahead

    def move_to(self, address: int) -> bool:
        """Move the pointer forward to `address`; return whether that lies ahead and inside the segment."""
        is_ahead = self._pointer <= address <= self._limit
        if is_ahead:
            self._pointer = address
        return is_ahead

    def largest_stretch(self, taken: Iterable[tuple[int, int]], align: int) -> tuple[int, int]:
        """Return start and size of the largest stretch that is not `taken`, from a multiple of `align`."""
        best = here = align_up(self.segment.start, align)
        best_nbytes = 0
        for start, end in sorted([*taken, *self._reserved, (self._limit, self._limit)]):
            if start - here > best_nbytes:
                best, best_nbytes = here, start - here
            here = max(here, align_up(end, align))
        return best, best_nbytes

    @property
    def usage(self) -> SegmentUsage:
        """How full the segment is now."""
        return self.usage_of(self.segment)

    def usage_of(self, segment: Segment) -> SegmentUsage:
        """Return how full `segment` is, this one or another processor's for the same memory."""
        return SegmentUsage(segment.name, segment.start, segment.nbytes, segment.nbytes - self.free_bytes)


def align_up(address: int, align: int) -> int:
    """Return the first multiple of `align` from `address` on."""
    return -(-address // align) * align
