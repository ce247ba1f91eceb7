"""Object code for the tests: bytes in an address space, and a processor that runs them."""

from __future__ import annotations

import numpy as np

from bfsim.blackfin.address_space import AddressSpace
from bfsim.blackfin.processor import Processor
from bfsim.blackfin.timing import GNU, Timing

CODE, DATA, NBYTES = 0x1000, 0x8000, 0x1000


def processor(code: str, timing: Timing = GNU, *, fuel: int | None = 10_000, **registers: int) -> Processor:
    """Return a core with `code` (bytes in hexadecimal) at CODE, a memory of zeros at DATA, the stack at its end, and registers."""
    space = AddressSpace()
    octets = bytes.fromhex(code)
    space.add(CODE, NBYTES).octets[: len(octets)] = np.frombuffer(octets, np.uint8)
    space.add(DATA, NBYTES)
    found = Processor(space, timing, fuel=fuel)
    for name, value in {"SP": DATA + NBYTES, **registers}.items():
        found.state[name] = value
    return found
