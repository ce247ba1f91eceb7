"""What comes next is read while the one before is worked on, and comes as if it were read when it is asked for."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import pytest

from bfsim.process.reading_ahead import read_ahead


def test_items_come_in_order() -> None:
    """All of them, None and False too."""
    assert list(read_ahead(iter([1, None, False, 2]))) == [1, None, False, 2]
    assert list(read_ahead(iter(()))) == []


def test_the_next_one_is_read_meanwhile() -> None:
    """Before it is asked for, and no more than one."""
    second_is_read, read = threading.Event(), []

    def items() -> Iterator[int]:
        for number in range(4):
            read.append(number)
            if number == 1:
                second_is_read.set()
            yield number

    ahead = read_ahead(items())
    assert next(ahead) == 0
    assert second_is_read.wait(timeout=60)
    assert read == [0, 1]
    ahead.close()  # type: ignore[attr-defined]  # a generator


def test_a_mistake_comes_where_it_is() -> None:
    """Behind the items before it."""

    def items() -> Iterator[int]:
        yield 1
        raise ValueError("cut")

    ahead = read_ahead(items())
    assert next(ahead) == 1
    with pytest.raises(ValueError, match="cut"):
        next(ahead)
