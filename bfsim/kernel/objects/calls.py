"""A call of a kernel's object code on arrays of the host."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from bfsim.blackfin.control_flow.convention import STACK, STACK_BYTES
from bfsim.blackfin.execution.guard import catch_always
from bfsim.blackfin.execution.object_calls import subroutine_call
from bfsim.blackfin.execution.placed import Placed, placed
from bfsim.blackfin.execution.subroutines import Subroutine
from bfsim.blackfin.instructions.event import Event
from bfsim.blackfin.translation.tracing import Followed, block_of
from bfsim.errors import KernelError
from bfsim.kernel.calls import crashes
from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.kernel.calls.python_calls import Check, left_by, log_of, words_of
from bfsim.kernel.calls.work import Work
from bfsim.kernel.language.function import Function
from bfsim.kernel.objects.compiled import CompiledObject
from bfsim.machine_code.calling import Taken
from bfsim.machine_code.left import FAILED


class ObjectCall:
    """A kernel's object code bound to its arrays.

    The Blackfin's memory has a window on the board's; other arrays are copied there for each call, and back.
    """

    def __init__(
        self,
        code: CompiledObject,
        arrays: Sequence[NDArray[Any]],
        check: Check,
        totals: NDArray[np.int64],
        access_trace: AccessTrace | None = None,
        first_site: int = 0,
        stack: NDArray[np.uint8] | None = None,
        memory: NDArray[np.uint8] | None = None,
    ) -> None:
        """`arrays`: in the order of the array parameters. `check` raises the error if the arguments of a call are wrong.

        `access_trace` gets the accesses of traced code to arrays; `first_site`: the number of the code's first site in
        it. `stack`: where the stack is, if its accesses are reported, too. `memory`: the board's, if all arrays lie in
        it.
        """
        function = code.function
        parts, addresses = _places(code, arrays, memory)
        trace = None
        if access_trace:
            trace = block_of(
                access_trace.address(), [*_followed(access_trace, arrays, addresses, first_site, stack)]
            )
        _catch_faults()
        self.stays_in_l1 = access_trace is None
        """Whether all its accesses stay in L1."""
        self.run: Callable[..., Work] = subroutine_call(
            code.subroutine,
            _arguments(function, arrays, addresses),
            len(function.parameters),
            parts,
            totals,
            left_by(function, access_trace, check, partial(_refuse, code.subroutine)),
            ctypes.addressof(trace) if trace else 0,
            log_of(access_trace) if access_trace else None,
            kept=(arrays, memory, trace, access_trace),
        )
        """Runs the code now and returns its cost, which is valid until the next run. It reads only the numbers."""
        if memory is None and (read_only := [*_read_only(code, arrays, addresses)]):
            self.run = partial(_run_beside, self.run, function, read_only)


def _places(
    code: CompiledObject, arrays: Sequence[NDArray[Any]], memory: NDArray[np.uint8] | None
) -> tuple[Sequence[Placed], list[int]]:
    """Return the parts of memory that arrays are copied to, none if they lie in a board's, and the address of each array."""
    space = code.subroutine.processor.space
    if memory is not None:
        from_host = space.window(memory) - memory.ctypes.data
        return (), [each.ctypes.data + from_host for each in arrays]
    named = zip(code.function.array_names, arrays, strict=True)
    written = [array.flags.writeable and code.may_write(name) for name, array in named]
    return placed(arrays, written, space)


def _followed(
    access_trace: AccessTrace,
    arrays: Sequence[NDArray[Any]],
    addresses: Sequence[int],
    first_site: int,
    stack: NDArray[np.uint8] | None,
) -> Iterator[Followed]:
    """Yield the memory whose accesses are reported: arrays, each with a site of its own, and the stack."""
    for number, (address, array) in enumerate(zip(addresses, arrays, strict=True)):
        host = array.ctypes.data
        if access_trace.logs(host):
            yield Followed(address, array.nbytes, host, first_site + number)
    if stack is not None:
        yield _followed_stack(stack, first_site + len(arrays))


def _read_only(
    code: CompiledObject, arrays: Sequence[NDArray[Any]], addresses: Sequence[int]
) -> Iterator[tuple[str, NDArray[Any], NDArray[np.uint8]]]:
    """Yield each read-only array that the code may store into: its name, the array, and the bytes of its copy."""
    space = code.subroutine.processor.space
    for name, array, address in zip(code.function.array_names, arrays, addresses, strict=True):
        if not array.flags.writeable and code.may_write(name):
            yield name, array, space.at(address, array.nbytes)


def _refuse(subroutine: Subroutine, failure: int) -> NoReturn:
    """Raise KernelError for the event that ended a call."""
    subroutine.refuse(Event(FAILED - failure))


def _run_beside(
    run: Callable[..., Work],
    function: Function,
    read_only: Sequence[tuple[str, NDArray[Any], NDArray[np.uint8]]],
    *arguments: Any,
) -> Work:
    """Run code that may store into read-only arrays; raise KernelError if it did so in their copies.

    `read_only`: of each its name, the array, and the bytes of its copy.
    """
    work = run(*arguments)
    for name, array, copied in read_only:
        if not np.array_equal(array.view(np.uint8), copied):
            raise KernelError(
                f"{name} must be writeable, because the kernel stores into it ({name} of {function.name}, "
                f"{function.place})"
            )
    return work


def _arguments(
    function: Function, arrays: Sequence[NDArray[Any]], addresses: Sequence[int]
) -> list[int | Taken]:
    """Return the arguments of the code: an array's address, and after the parameters the lengths that it asks for."""
    named = zip(function.array_names, arrays, strict=True)
    lengths = (len(array) for name, array in named if name in function.measured)
    return [*words_of(function, ([each] for each in addresses)), *lengths]


@cache
def _catch_faults() -> None:
    """Catch faults in object code before the handler that reports crashes, which does not pass them on unchanged."""
    crashes.take_signals()
    catch_always()


def _followed_stack(stack: NDArray[np.uint8], site: int) -> Followed:
    """Return the stack from its top, where the board's and the code's both begin, as far down as both reach."""
    nbytes = min(STACK_BYTES, len(stack))
    return Followed(STACK + STACK_BYTES - nbytes, nbytes, stack[len(stack) - nbytes :].ctypes.data, site)
