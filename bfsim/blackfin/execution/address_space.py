"""The Blackfin's address space of 4 GB, in this process: memories where it has some, and nothing elsewhere.

A memory is its own, or a window on memory that others have, too, such as that of a simulated board.
"""

from __future__ import annotations

import ctypes
import mmap
from dataclasses import dataclass, field
from typing import Any
from weakref import ref

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import ConfigError

SPAN_BYTES = 1 << 32
NO_ACCESS = 0
"""Protection of the host's pages: any access is a fault."""
WINDOWS = 0x20000000
"""[HRM] Asynchronous memory, where no program is linked: windows are here, and after it if it is full."""
MAP_FIXED, MREMAP_MAYMOVE, MREMAP_FIXED = 0x10, 1, 2
"""Linux: pages are mapped at an address, whatever is there."""
FAILED = ctypes.c_void_p(-1).value


@dataclass(frozen=True, slots=True)
class Memory:
    """A memory at an address; its size is in whole pages of the host. `shared`: what it is a window on, while that exists."""

    base: int
    octets: NDArray[np.uint8]
    shared: ref[NDArray[np.uint8]] | None = None

    @property
    def end(self) -> int:
        """The address after it."""
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
    """A reservation of 4 GB and a page of the host's addresses, in which only the memories are backed.

    `origin`: the host's address of address 0. Raises ConfigError if the host refuses, for example under a limit of
    addresses.
    """

    memories: list[Memory] = field(default_factory=list)
    origin: int = field(init=False)
    _map: mmap.mmap = field(init=False)

    def __post_init__(self) -> None:
        # without access from the start, so that the host need not promise 4 GB of memory
        flags = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS
        try:
            self._map = mmap.mmap(-1, SPAN_BYTES + mmap.PAGESIZE, flags=flags, prot=NO_ACCESS)
        except OSError as error:
            raise ConfigError(
                "this system must allow a process 4 GB of addresses, without memory, to run the code that a compiler made of "
                f"kernels ({error.strerror}); `ulimit -v unlimited` does, and `--profile gcc-O2`, which estimates, needs none"
            ) from error
        self.origin = np.frombuffer(self._map, np.uint8).ctypes.data

    def add(self, base: int, nbytes: int) -> Memory:
        """Add a memory of zeros at an address, rounded outwards to pages of the host. Raises ConfigError if one is there."""
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

    def window(self, shared: NDArray[np.uint8]) -> int:
        """Return the address of a window on memory of the host, the same bytes: whole pages of a shared mapping."""
        for each in self.memories:
            if each.shared and each.shared() is shared:
                return each.base
        self._close_windows()
        base = self._gap(len(shared))
        _lay(shared.ctypes.data, len(shared), self.origin + base)
        octets = np.asarray(_Pages(self._map, self.origin + base, len(shared)))
        self.memories.append(Memory(base, octets, ref(shared)))
        return base

    def _close_windows(self) -> None:
        """Give up windows whose memory is gone."""
        kept = []
        for each in self.memories:
            if each.shared and each.shared() is None:
                _reserve(self.origin + each.base, len(each.octets))
            else:
                kept.append(each)
        self.memories = kept

    def _gap(self, nbytes: int) -> int:
        """Return the first address for a window of `nbytes` bytes. Raises ConfigError if there is none."""
        start = WINDOWS
        for each in sorted(self.memories, key=lambda each: each.base):
            if each.base < start + nbytes and start < each.end:
                start = each.end
        if start + nbytes > SPAN_BYTES:
            raise ConfigError(
                f"an address space must have room for {nbytes:,} bytes of a board's memory, but has none"
            )
        return start

    def at(self, address: int, nbytes: int) -> NDArray[np.uint8]:
        """Return the bytes at an address, to read and to write. Raises ConfigError if there is no memory."""
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


def _reserve(address: int, nbytes: int) -> None:
    """Unmap addresses, and keep them reserved."""
    flags = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | MAP_FIXED
    _host("mmap", address, nbytes, NO_ACCESS, flags, -1, 0)


def _lay(source: int, nbytes: int, target: int) -> None:
    """Map the pages of a shared mapping at a second address, too: Linux does so when asked to move 0 bytes of them."""
    _host("mremap", source, 0, nbytes, MREMAP_MAYMOVE | MREMAP_FIXED, target)


def _host(name: str, address: int, *words: int) -> None:
    """Call a function of the C library that lays out pages."""
    call = getattr(ctypes.CDLL(None, use_errno=True), name)
    call.restype = ctypes.c_void_p
    if call(ctypes.c_void_p(address), *map(ctypes.c_ssize_t, words)) == FAILED:
        raise OSError(ctypes.get_errno(), "the host does not lay out memory")
