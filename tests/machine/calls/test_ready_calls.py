"""Calls that machine code finds: by the kernel and its rows, in the stage and the turn in which they can be made."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

import pytest

from bfsim.kernel import Kernel
from bfsim.machine.calls import ready_calls
from bfsim.machine.calls.ready_calls import ALWAYS, MOST_ARGUMENTS, ReadyCalls, find_call
from tests.machine.kernels import copy, negate, spin

FIND = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64)
ONE, OTHER, THIRD = (object() for _ in range(3))
ASKED = 7, 8, 9


@pytest.fixture
def ready() -> ReadyCalls:
    """Return the calls of a core in its first stage."""
    calls = ReadyCalls()
    calls.enter("Work")
    return calls


def found(ready: ReadyCalls, kernel: Kernel, arguments: Sequence[object], turn: int = 0) -> list[int] | None:
    """Return what is asked for by a kernel and its arguments, if machine code finds that."""
    told = (ctypes.c_int64 * (1 + len(arguments)))(id(kernel), *map(id, arguments))
    call = FIND(find_call.address())(ready.at, ctypes.addressof(told), len(told), turn)
    return list((ctypes.c_int64 * 3).from_address(ready.at + 8 * call)) if call else None


def test_a_call_is_found_by_its_kernel_and_its_rows(ready: ReadyCalls) -> None:
    """In their order; of its numbers nothing is asked."""
    ready.lay(copy, (ONE, OTHER), ALWAYS, ASKED)
    ready.lay(spin, (1000,), ALWAYS, (1, 2, 3))
    assert found(ready, copy, (ONE, OTHER)) == list(ASKED)
    assert found(ready, spin, (2000,)) == [1, 2, 3]
    for kernel, rows in (
        (copy, (OTHER, ONE)),
        (negate, (ONE, OTHER)),
        (copy, (ONE,)),
        (copy, (ONE, OTHER, 1)),
        (copy, ()),
    ):
        assert found(ready, kernel, rows) is None


def test_stages_have_calls_of_their_own(ready: ReadyCalls) -> None:
    """Each counts its own."""
    ready.lay(copy, (ONE, OTHER), ALWAYS, ASKED)
    ready.enter("Object detection")
    assert found(ready, copy, (ONE, OTHER)) is None
    ready.lay(copy, (ONE, OTHER), ALWAYS, (1, 2, 3))
    assert found(ready, copy, (ONE, OTHER)) == [1, 2, 3]
    ready.enter("Work")
    assert found(ready, copy, (ONE, OTHER)) == list(ASKED)


def test_a_call_of_one_turn_is_not_found_in_the_next(ready: ReadyCalls) -> None:
    """Until it is laid there again."""
    ready.lay(copy, (ONE, OTHER), 3, ASKED)
    assert [found(ready, copy, (ONE, OTHER), turn) for turn in (2, 3, 4)] == [None, list(ASKED), None]
    ready.lay(copy, (ONE, OTHER), 4, ASKED)
    assert [found(ready, copy, (ONE, OTHER), turn) for turn in (3, 4)] == [None, list(ASKED)]


@pytest.mark.parametrize("room", ["PLACES", "CALLS_AT"])
def test_more_calls_than_there_is_room_for_begin_anew(ready: ReadyCalls, room: str) -> None:
    """And those that come then are found."""
    rows = [object() for _ in range(getattr(ready_calls, room))]
    for each in rows:
        ready.lay(copy, (each, ONE), ALWAYS, (7, 8, id(each)))
        assert found(ready, copy, (each, ONE)) == [7, 8, id(each)]
    known = [found(ready, copy, (each, ONE)) is not None for each in rows]
    assert 0 < sum(known) < len(rows)
    assert known == sorted(known)


def test_a_call_of_more_arguments_than_there_is_room_for_is_python_s(ready: ReadyCalls) -> None:
    """Nothing is laid."""
    many = [object() for _ in range(MOST_ARGUMENTS)]
    ready.lay(copy, many, ALWAYS, ASKED)
    assert found(ready, copy, many) is None
    ready.lay(copy, many[1:], ALWAYS, ASKED)
    assert found(ready, copy, many[1:]) == list(ASKED)
