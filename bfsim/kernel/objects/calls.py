"""A call of a kernel's object code on arrays of the host."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from functools import cache, partial
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from bfsim.blackfin.caller import Kind
from bfsim.blackfin.calling import Argument, Counts, Log, bound_call
from bfsim.blackfin.event import Event
from bfsim.blackfin.guard import catch_always
from bfsim.blackfin.left import FAILED, NO_ROOM, WORD_BITS, Left, Result
from bfsim.blackfin.subroutines import STACK, STACK_BYTES, Placed, Subroutine, placed
from bfsim.blackfin.tracing import Followed, block_of
from bfsim.kernel import crashes
from bfsim.kernel.access_trace import ENTRIES, KEPT, ROOM, AccessTrace
from bfsim.kernel.function import Function
from bfsim.kernel.objects.compiled import CompiledObject
from bfsim.kernel.types import ArrayType, FloatType, IntType, u32
from bfsim.kernel.work import Work


class ObjectCall:
    """A kernel's object code bound to its arrays.

    The Blackfin's memory has a window on that of a board; other arrays are copied there for each call, and back.
    """

    def __init__(
        self,
        code: CompiledObject,
        arrays: Sequence[NDArray[Any]],
        check: Callable[[Sequence[object]], None],
        totals: NDArray[np.int64],
        access_trace: AccessTrace | None = None,
        first_site: int = 0,
        stack: NDArray[np.uint8] | None = None,
        memory: NDArray[np.uint8] | None = None,
    ) -> None:
        """`arrays`: in the order of the array parameters. `check` raises the error when the arguments of a call are wrong.

        `access_trace` is told of accesses to arrays, by traced code; it calls the code's first site `first_site`. `stack`: where the
        stack is, if its accesses are told, too. `memory`: that of the board, if all arrays lie in it.
        """
        function = code.function
        space = code.subroutine.processor.space
        parts: Sequence[Placed] = ()
        if memory is None:
            named = zip(function.array_names, arrays, strict=True)
            written = [array.flags.writeable and code.may_write(name) for name, array in named]
            parts, addresses = placed(arrays, written, space)
        else:
            from_host = space.window(memory) - memory.ctypes.data
            addresses = [each.ctypes.data + from_host for each in arrays]
        log = None
        if access_trace:
            followed = [
                Followed(address, array.nbytes, array.ctypes.data, first_site + number)
                for number, (address, array) in enumerate(zip(addresses, arrays, strict=True))
                if access_trace.logs(array.ctypes.data)
            ]
            if stack is not None:
                followed.append(_followed_stack(stack, first_site + len(arrays)))
            trace = block_of(access_trace.address(), followed)
            logged, before, room = (access_trace.address_of(word) for word in (ENTRIES, KEPT, ROOM))
            log = Log(ctypes.addressof(trace), logged, before, room, (trace, access_trace))
        _catch_faults()
        work = Work(0, 0)  # one for all runs: to make it takes Python longer than to run a short kernel
        left = Left(
            work, work.at, *_result(function), partial(_refuse, check, code.subroutine, access_trace, work)
        )
        counts = Counts(totals[: len(code.order)], code.order)
        given, taken = len(function.parameters), _arguments(function, arrays, addresses)
        self.stays_in_l1 = access_trace is None
        """Whether no access of it can leave L1."""
        kept = arrays, memory
        self.run: Callable[[Sequence[Any]], Work] = bound_call(
            code.subroutine, taken, given, parts, counts, left, log, kept
        )
        """Runs the code now and says what it cost, until the next run. Of its arguments, only the numbers are read."""


def _refuse(
    check: Callable[[Sequence[object]], None], subroutine: Subroutine, access_trace: AccessTrace | None, work: Work,
    arguments: Sequence[object],
) -> NoReturn:  # fmt: skip
    """Raise KernelError for a call that failed: `work` says why."""
    if access_trace and work.issue_cclk == NO_ROOM:
        access_trace.check_room(work.accesses)
    check(arguments)
    subroutine.refuse(Event(FAILED - work.issue_cclk))


def _result(function: Function) -> tuple[Result, int]:
    """Return what R0 is when a function returns, and of how many bits: of a narrow type it has the lower ones."""
    kind = function.result
    if isinstance(kind, IntType):
        return (Result.SIGNED if kind.signed else Result.UNSIGNED), kind.bits
    return (Result.FLOAT if kind else Result.NONE), WORD_BITS


def _arguments(
    function: Function, arrays: Sequence[NDArray[Any]], addresses: Sequence[int]
) -> list[Argument]:
    """Return what the code takes: of an array its address, and behind the parameters the lengths that it asks for."""
    places = iter(addresses)
    found = []
    for each in function.parameters:
        if isinstance(each.type, ArrayType):
            found.append(_fixed(next(places)))
        elif isinstance(each.type, FloatType):
            found.append(Argument(Kind.FLOAT, *u32.bounds))
        else:
            found.append(Argument(Kind.INTEGER, *each.type.bounds))
    named = zip(function.array_names, arrays, strict=True)
    return found + [_fixed(len(array)) for name, array in named if name in function.measured]


def _fixed(value: int) -> Argument:
    return Argument(Kind.FIXED, value, value)


@cache
def _catch_faults() -> None:
    """Take the signal of a fault in object code, behind whoever tells of crashes: it does not hand a fault on as it was."""
    crashes.take_signals()
    catch_always()


def _followed_stack(stack: NDArray[np.uint8], site: int) -> Followed:
    """The stack from its top, where both begin, as far down as both reach."""
    nbytes = min(STACK_BYTES, len(stack))
    return Followed(STACK + STACK_BYTES - nbytes, nbytes, stack[len(stack) - nbytes :].ctypes.data, site)
