"""What is read once: the same arguments, in one block, and never across two."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import pytest

from bfsim.process.once import Known, once, remembering, remembering_here

CALLED: list[object] = []


@once
def told(what: object, by: Mapping[str, str] = {}, among: Sequence[object] = ()) -> list[object]:
    """Note that it was called."""
    CALLED.append(what)
    if what == "wrong":
        raise ValueError("no such thing")
    return [what, dict(by), among]


@pytest.fixture(autouse=True)
def _nothing_called() -> None:
    CALLED.clear()


def test_without_a_block_all_is_called() -> None:
    """As often as it is asked for."""
    assert told(1) == told(1)
    assert CALLED == [1, 1]


def test_a_block_within_another_one_remembers_what_that_does() -> None:
    """And forgets at its end what it was the first to remember."""
    with remembering_here():
        first = told(1)
        with remembering_here():
            assert told(1) is first
        assert told(1) is first
    assert told(1) is not first


def test_the_same_arguments_are_called_once_in_a_block() -> None:
    """By value where they are text, numbers, or lists and tables of these; where they are other objects, the same one."""
    one, other = object(), object()
    with remembering({}):
        first = told("a", {"x": "1"}, [2])
        assert told("a", {"x": "1"}, (2,)) is first
        assert told("a", {"x": "2"}, [2]) is not first
        assert told(one) is told(one)
        told(other)
        assert told(1) is not told(True)  # noqa: FBT003 - equal, and another value
    assert ["a", "a", one, other, 1, True] == CALLED


def test_a_block_goes_on_with_what_it_is_given() -> None:
    """A new one begins anew, also within another one."""
    known: Known = {}
    for kept in (known, known, {}):
        with remembering(kept):
            told("a")
    assert CALLED == ["a", "a"]


def test_an_object_that_is_gone_is_not_taken_for_a_new_one() -> None:
    """Which would have its address."""
    with remembering({}):
        for _ in range(100):
            told(object())
    assert len(CALLED) == 100


def test_a_mistake_is_made_again() -> None:
    """For each who asks."""
    with remembering({}):
        for _ in range(2):
            with pytest.raises(ValueError, match="no such thing"):
                told("wrong")
    assert CALLED == ["wrong", "wrong"]
