"""What machine code takes from a call in Python and what it leaves, as the kernel declares it (`machine_code.calling`)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, NoReturn

from bfsim.kernel.calls.access_log import ENTRIES, KEPT, ROOM
from bfsim.kernel.calls.access_trace import AccessTrace
from bfsim.kernel.calls.work import Work
from bfsim.kernel.language.function import Function
from bfsim.kernel.types import ArrayType, FloatType, IntType, u32
from bfsim.machine_code.caller import NumberKind
from bfsim.machine_code.calling import Log, Taken
from bfsim.machine_code.left import NO_ROOM, WORD_BITS, Left, Result

Check = Callable[[Sequence[object]], None]
"""Raises the error when the arguments of a call are wrong."""


def words_of(function: Function, arrays: Iterable[Sequence[int]]) -> list[int | Taken]:
    """Return the words for the parameters: for an array, those of the next of `arrays`; for a number, one."""
    words: list[int | Taken] = []
    following = iter(arrays)
    for position, each in enumerate(function.parameters):
        if isinstance(each.type, ArrayType):
            words += next(following)
        elif isinstance(each.type, FloatType):
            words.append(Taken(position, NumberKind.FLOAT, *u32.bounds))
        else:
            words.append(Taken(position, NumberKind.INTEGER, *each.type.bounds))
    return words


def left_by(
    function: Function, access_trace: AccessTrace | None, check: Check, refuse: Callable[[int], NoReturn]
) -> Left:
    """Return what a call leaves. If it fails, `check` raises KernelError for wrong arguments, else `refuse` with the reason."""
    work = Work(0, 0)  # one for all runs: making one takes Python longer than running a short kernel

    def fail(*arguments: Any) -> NoReturn:
        if access_trace and work.issue_cclk == NO_ROOM:
            access_trace.check_room(work.accesses)
        check(arguments)
        refuse(work.issue_cclk)

    kind, bits = function.result, WORD_BITS
    result = Result.FLOAT if kind else Result.NONE
    if isinstance(kind, IntType):
        result, bits = (Result.SIGNED if kind.signed else Result.UNSIGNED), kind.bits
    return Left(work, work.at, result, bits, fail)


def log_of(access_trace: AccessTrace) -> Log:
    """Return where accesses are logged."""
    return Log(*map(access_trace.address_of, (ENTRIES, KEPT, ROOM)))
