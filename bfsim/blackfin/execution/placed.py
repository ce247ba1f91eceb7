"""Where the arrays of a call lie in the Blackfin's memory while a function runs."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from bfsim.blackfin.execution.address_space import AddressSpace
from bfsim.errors import KernelError

ARRAYS, ARRAYS_BYTES = 0x20000000, 64 << 20
"""[HRM] Asynchronous memory, where no program is linked: the place of arrays."""
ARRAY_ALIGN = 16
"""As numpy aligns its own arrays on the host, so that their place there does not matter."""


@dataclass(frozen=True, slots=True)
class Placed:
    """Memory at an address of the host that has a copy in the Blackfin's memory while a function runs.

    `copy`: the host's address of the copy. It is copied back only if it is written.
    """

    address: int
    copy: int
    nbytes: int
    is_written: bool


def placed(
    arrays: Sequence[NDArray[Any]], written: Sequence[bool], space: AddressSpace
) -> tuple[list[Placed], list[int]]:
    """Give arrays places in the Blackfin's memory; return these and the address of each array. They overlap there as here.

    `written`: whether an array may be stored into.

    They lie there in the order of the arguments, wherever they are here: code may compare addresses, and its cycles
    must not depend on the host's addresses. Raises KernelError if there is no room for them.
    """
    ranges = [(first := each.ctypes.data, first + each.nbytes) for each in arrays]
    joined = list(joined_ranges(ranges))
    starts = [low for low, _ in joined]
    parts: list[Placed] = []
    place_of: dict[int, int] = {}
    address, addresses = ARRAYS, []
    for first, _ in ranges:
        number = bisect_right(starts, first) - 1
        low, high = joined[number]
        if number not in place_of:
            place_of[number] = address = -(-address // ARRAY_ALIGN) * ARRAY_ALIGN + low % ARRAY_ALIGN
            nbytes = high - low
            if address + nbytes > ARRAYS + ARRAYS_BYTES:
                raise KernelError(f"the arrays of a call must fit into {ARRAYS_BYTES:,} bytes, but do not")
            stores = zip(written, ranges, strict=True)
            is_written = any(each and low <= begin < high for each, (begin, _) in stores)
            parts.append(Placed(low, space.origin + address, nbytes, is_written))
            address += nbytes
        addresses.append(place_of[number] + first - low)
    return parts, addresses


def joined_ranges(ranges: Iterable[tuple[int, int]]) -> Iterator[tuple[int, int]]:
    """Yield ranges in their order, those that overlap or meet as one."""
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
