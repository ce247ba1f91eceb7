"""Calls of subroutines, bound to their arguments, memory and counts."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.blackfin.control_flow.convention import REGISTERS, STACK, STACK_BYTES
from bfsim.blackfin.execution import object_caller as w
from bfsim.blackfin.execution.guard import runner
from bfsim.blackfin.execution.placed import Placed
from bfsim.blackfin.execution.subroutines import Subroutine
from bfsim.blackfin.instructions.registers import WORD_BYTES
from bfsim.machine_code.calling import Called, Log, Taken, bound_call
from bfsim.machine_code.left import Left


def subroutine_call(
    subroutine: Subroutine,
    arguments: Sequence[int | Taken],
    given: int,
    parts: Sequence[Placed],
    totals: NDArray[np.int64],
    left: Left,
    trace: int = 0,
    log: Log | None = None,
    kept: object = None,
) -> Callable[..., Any]:
    """Return a subroutine bound to its memory, to be called with `given` arguments in Python. It adds its counts to `totals`.

    `arguments`: what it takes, in 32 bits each: the same for all calls, or taken from the call. `trace`: the address of
    the block through which accesses are reported, if they are; `log`: where they are logged. `kept`: what else must
    live as long as it does, such as the memory of its arrays.
    """
    translated, state = subroutine.translated, subroutine.processor.state
    handed = [*arguments, *([0] * (len(REGISTERS) - len(arguments)))]
    values = {
        w.RUN: runner().guarded,
        w.CODE: translated.entry,
        w.MEMORY: subroutine.processor.space.origin,
        w.STATE: state.slots.ctypes.data,
        w.TOTALS: totals.ctypes.data,
        w.ADDRESS: subroutine.address,
        w.TOP: STACK + STACK_BYTES - WORD_BYTES * len(handed),
        w.WORDS: len(handed),
        w.PARTS: len(parts),
        w.TRACE: trace,
    }
    words = [values[each] for each in range(w.HEAD)]
    for each in parts:
        words += each.address, each.copy, each.nbytes, each.nbytes * each.is_written
    data = (ctypes.c_int64 * len(words))(*words)
    called = Called(w.object_caller(), ctypes.addressof(data), (data, subroutine, totals, kept))
    return bound_call(called, handed, given, left, log)
