"""Object code for the tests: bytes in an address space, and a processor that runs them."""

from __future__ import annotations

import numpy as np

from bfsim.blackfin.execution.address_space import AddressSpace
from bfsim.blackfin.execution.processor import Processor
from bfsim.blackfin.timing.tables import GNU, Timing

CODE, DATA, NBYTES = 0x1000, 0x8000, 0x1000
ISQRT = "0960 1830 f14f 0060 8268 b2e00820 8850 9309 084e 031c d352 0850 114e 1000"
"""[GCC] The root of R0, a bit a turn: `R3 = R3 - R2; R0 = R0 + R1;` are jumped over where the bit is 0."""


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
