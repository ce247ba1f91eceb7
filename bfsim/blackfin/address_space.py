"""The Blackfin's address space of 4 GB, in this process: memories where it has some, and nothing elsewhere."""

from __future__ import annotations

import ctypes
import mmap
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import ConfigError

SPAN_BYTES = 1 << 32
NO_ACCESS = 0
"""Of the host's pages: an access is a fault."""


@dataclass(frozen=True, slots=True)
class Memory:
    """A memory at an address; its size is in whole pages of the host."""

    base: int
    octets: NDArray[np.uint8]

    @property
    def end(self) -> int:
        """The address behind it."""
        return self.base + len(self.octets)


@dataclass(frozen=True, slots=True)
class _Pages:
    """Pages of the host, as numpy takes them; an array of them keeps the reservation."""

    reservation: mmap.mmap
    address: int
    nbytes: int

    @property
    def __array_interface__(self) -> dict[str, Any]:
        return {"version": 3, "shape": (self.nbytes,), "typestr": "|u1", "data": (self.address, False)}


@dataclass(slots=True)
class AddressSpace:
    """A reservation of 4 GB and a page of the host's addresses, of which only the memories are backed.

    `origin`: the host's address of address 0.
    """

    memories: list[Memory] = field(default_factory=list)
    origin: int = field(init=False)
    _map: mmap.mmap = field(init=False)

    def __post_init__(self) -> None:
        # without access from the start, so that the host need not promise 4 GB of memory
        flags = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS
        self._map = mmap.mmap(-1, SPAN_BYTES + mmap.PAGESIZE, flags=flags, prot=NO_ACCESS)
        self.origin = np.frombuffer(self._map, np.uint8).ctypes.data

    def add(self, base: int, nbytes: int) -> Memory:
        """Have a memory of zeros at an address, rounded outwards to pages of the host. Raises ConfigError if one is there already."""
        start = base & -mmap.PAGESIZE
        end = -(-(base + nbytes) // mmap.PAGESIZE) * mmap.PAGESIZE
        for each in self.memories:
            if start < each.end and each.base < end:
                raise ConfigError(
                    f"the memories of an address space must not overlap, but {start:#010x} to {end:#010x} overlaps "
                    f"{each.base:#010x} to {each.end:#010x}"
                )
        _protect(self.origin + start, end - start, mmap.PROT_READ | mmap.PROT_WRITE)
        octets = np.asarray(_Pages(self._map, self.origin + start, end - start))
        self.memories.append(Memory(start, octets))
        return self.memories[-1]

    def at(self, address: int, nbytes: int) -> NDArray[np.uint8]:
        """Return the bytes at an address, to read and to write. Raises ConfigError where there is no memory."""
        for each in self.memories:
            if each.base <= address and address + nbytes <= each.end:
                return each.octets[address - each.base : address - each.base + nbytes]
        raise ConfigError(f"there must be memory for {nbytes:,} bytes at {address:#010x}, but there is none")

    def fetch(self, address: int) -> bytes:
        """Return the 8 bytes at an address, or as many as there are."""
        for each in self.memories:
            if each.base <= address < each.end:
                return each.octets[address - each.base :][:8].tobytes()
        return b""


def _protect(address: int, nbytes: int, access: int) -> None:
    protect = ctypes.CDLL(None, use_errno=True).mprotect
    if protect(ctypes.c_void_p(address), ctypes.c_size_t(nbytes), access):
        raise OSError(ctypes.get_errno(), "the host does not protect memory")
