"""Machine code as a built-in function of Python: numbers that are bound come first, then those that it is given."""

from __future__ import annotations

from ctypes import addressof, c_int64
from threading import Thread

import pytest

from bfsim import machine_code
from bfsim.machine_code.built_in import built_in

DIGITS = """
define i64 @digits_of_four(i64 %a, i64 %b, i64 %c, i64 %d) {
  %a.high = mul i64 %a, 1000
  %b.high = mul i64 %b, 100
  %c.high = mul i64 %c, 10
  %ab = add i64 %a.high, %b.high
  %cd = add i64 %c.high, %d
  %all = add i64 %ab, %cd
  ret i64 %all
}
"""


@pytest.fixture(scope="module")
def digits() -> int:
    """Return the address of a function of four digits."""
    machine_code.add(machine_code.host_code(DIGITS))
    return machine_code.address_of("digits_of_four")


@pytest.mark.parametrize("bound", range(5))
def test_numbers_are_bound_or_given(digits: int, bound: int) -> None:
    """However many are bound."""
    numbers = 5, 6, 1, 4
    assert built_in(digits, 4 - bound, *numbers[:bound])(*numbers[bound:]) == 5614


def test_all_numbers_have_64_bits(digits: int) -> None:
    """With their signs."""
    assert built_in(digits, 1, 0, 0, 0)(-1) == -1
    assert built_in(digits, 2, 0, -1)(0, 1 << 40) == (1 << 40) - 100


def test_what_is_bound_lives_as_long_as_the_function(digits: int) -> None:
    """Nobody else keeps it."""
    made = [built_in(digits, 0, 0, 0, 0, number) for number in range(1000)]
    assert [each() for each in made] == list(range(1000))


WAIT_FOR = """
define i64 @wait_for_a_word(i64 %at, i64 %turns) {
entry:
  %word = inttoptr i64 %at to ptr
  br label %turn
turn:
  %number = phi i64 [ 0, %entry ], [ %next, %turn ]
  %value = load volatile i64, ptr %word
  %next = add i64 %number, 1
  %is.there = icmp ne i64 %value, 0
  %is.last = icmp eq i64 %next, %turns
  %ends = or i1 %is.there, %is.last
  br i1 %ends, label %end, label %turn
end:
  ret i64 %value
}
"""


def test_other_threads_run_meanwhile() -> None:
    """One sets the word that the function waits for."""
    machine_code.add(machine_code.host_code(WAIT_FOR))
    word, turns = c_int64(0), 1 << 34
    wait_for = built_in(machine_code.address_of("wait_for_a_word"), 1, addressof(word), others_run=True)
    other = Thread(target=lambda: setattr(word, "value", 5))
    other.start()
    assert wait_for(turns) == 5
    other.join()
