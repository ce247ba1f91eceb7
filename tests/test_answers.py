"""Functions whose answers machine code chooses, and answers that `yield from` has at once."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable, Generator
from typing import Any

import pytest

from bfsim import machine_code
from bfsim.machine_code.answers import answering, over

CHOICE = """
define i64 @bfsim_test_choice(ptr %word, i64 %least) {
  %value = load i64, ptr %word
  %number = sub i64 %value, %least
  ret i64 %number
}
"""


def awaiting(wait: Any, times: int = 1) -> Generator[Any, Any, list[object]]:
    """Wait so often; return what that gives."""
    found = []
    for _ in range(times):
        found.append((yield from wait))
    return found


def outcome(task: Generator[Any, Any, Any]) -> Any:
    """Return what a generator returns that waits for nobody."""
    try:
        next(task)
    except StopIteration as ended:
        return ended.value
    raise AssertionError("it waits for somebody")


@pytest.mark.parametrize("value", [None, "row", (1, 2), StopIteration(3), ValueError("no")])
@pytest.mark.parametrize("trace", [None, lambda *_: None])
def test_yield_from_has_what_is_over_at_once_as_often_as_it_asks(
    value: object, trace: Callable[..., None] | None
) -> None:
    """Whatever the value is, and while a debugger looks on, which makes CPython take another way."""
    wait, before = over(value), sys.gettrace()
    sys.settrace(trace)
    try:
        found = outcome(awaiting(wait, 3))
    finally:
        sys.settrace(before)
    assert len(found) == 3
    assert all(each is value for each in found)


def test_what_is_over_holds_its_value_no_longer_than_it_lives() -> None:
    """One reference for each, none when it was awaited."""
    value = object()
    before = sys.getrefcount(value)
    wait = over(value)
    assert sys.getrefcount(value) == before + 1
    outcome(awaiting(wait, 5))
    assert sys.getrefcount(value) == before + 1
    del wait
    assert sys.getrefcount(value) == before


@pytest.fixture(scope="module")
def choice() -> int:
    """Return the address of code that returns the difference of a word in memory and a number."""
    machine_code.add(machine_code.host_code(CHOICE))
    return machine_code.address_of("bfsim_test_choice")


def test_machine_code_chooses_the_answer_or_python_is_asked(choice: int) -> None:
    """Numbers are counted from 0; a negative one is none."""
    word = ctypes.c_int64(7)
    ask = answering(choice, (ctypes.addressof(word), 7), ("first", "second"), lambda: "python")
    found = []
    for word.value in (7, 8, 6, 7, -100):
        found.append(ask())
    assert found == ["first", "second", "python", "first", "python"]


def test_what_python_raises_comes_out_of_an_answer(choice: int) -> None:
    """A ring has many things to refuse."""

    def refuse() -> None:
        raise ValueError("no line 3")

    word = ctypes.c_int64(0)
    ask = answering(choice, (ctypes.addressof(word), 1), (), refuse)
    with pytest.raises(ValueError, match="no line 3"):
        ask()


def test_a_function_of_answers_takes_none(choice: int) -> None:
    """As a method of Python would refuse it."""
    with pytest.raises(TypeError, match="takes no arguments"):
        answering(choice, (0, 0), (), list)(1)  # type: ignore[call-arg]
