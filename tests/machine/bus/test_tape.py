"""The tape of a core that runs ahead: what it notes is where the bus plays it."""

from __future__ import annotations

from collections.abc import Callable
from ctypes import addressof
from functools import partial

import numpy as np
import pytest

from bfsim.kernel import Work
from bfsim.machine.bus import state as w
from bfsim.machine.bus.tape import MOST_OPERATIONS, Tape
from bfsim.machine.bus.tape_lines import COPY_WORDS, DONE, NotedLines, ring_words
from tests.machine.bench import Bench

CORE, CALL = 1, 11
MEET = w.CATCH_UP, 0, 0, 0, 0
PROGRAM = w.SET_UP, 60, 5, 7, 3
NO_PLAN = (w.NONE,) * COPY_WORDS
RING = 5, w.RING_FULL, 60, 7, 3


@pytest.fixture
def bench() -> Bench:
    """Return a bus."""
    return Bench()


@pytest.fixture
def tape(bench: Bench) -> Tape:
    """Return the tape of a core on it."""
    return taking(bench, CORE)


def taking(bench: Bench, core: int) -> Tape:
    """Return the tape of a core that runs ahead."""
    tape = bench.bus.tape(core)
    tape.takes_calls = True
    return tape


def noted(tape: Tape) -> list[tuple[int, ...]]:
    """Return what a tape has noted, without the calls that it was noted of."""
    return [tuple(each[: w.OF_CALL]) for each in tape.operations(0, tape.noted).tolist()]


class Ring:
    """The lines of a ring, as its core notes them: each function of `NotedLines`, told where their words are."""

    def __init__(self, tape: Tape, copies: tuple[tuple[int, ...], ...]) -> None:
        self._words = np.array([len(copies), *RING, *(word for each in copies for word in each)])
        self._notes = NotedLines(tape)

    def __getattr__(self, name: str) -> Callable[..., int]:
        return partial(getattr(self._notes, name), self._words.ctypes.data)


def ring(tape: Tape, *copies: tuple[int, ...]) -> Ring:
    """Return a ring with so many lines."""
    return Ring(tape, copies)


def run(tape: Tape, issue_cclk: int, stall_cclk: int = 0) -> int:
    """Note a call that has met nobody."""
    work = Work(issue_cclk, stall_cclk)
    return tape.note_run(work.at, CALL)


def test_the_first_calls_of_all_are_not_noted(tape: Tape) -> None:
    """The core's clock is known until something else is."""
    assert not run(tape, 7, 2)
    tape.note(*MEET)
    assert run(tape, 7, 2)
    assert noted(tape) == [MEET, (w.RUN, 7, 2, 0, 0)]


def test_calls_that_meet_nobody_are_noted_as_one(tape: Tape) -> None:
    """But not across what was noted between them, nor across a mark, where something is done at that moment."""
    tape.note(*MEET)
    for _ in range(3):
        run(tape, 7, 2)
    tape.note(*MEET)
    run(tape, 1, 0)
    assert tape.mark() == 4
    run(tape, 5, 0)
    run(tape, 6, 0)
    assert noted(tape) == [MEET, (w.RUN, 21, 6, 0, 0), MEET, (w.RUN, 1, 0, 0, 0), (w.RUN, 11, 0, 0, 0)]


def test_a_mark_is_gone_with_what_was_before_it(tape: Tape) -> None:
    """The next stretch begins anew."""
    tape.note(*MEET)
    tape.mark()
    tape.clear()
    assert tape.noted == tape.mark() == 0


def test_accesses_of_calls_stand_behind_each_other(tape: Tape) -> None:
    """Each call has those that it logged, and its number."""
    for number, accesses in enumerate((3, 0, 4)):
        work = Work(10, 1, accesses=accesses)
        tape.note_access(work.at, CALL + number)
    assert tape.operations(0, tape.noted)[:, w.OF_CALL].tolist() == [CALL, CALL + 1, CALL + 2]
    assert noted(tape) == [(w.ACCESS, 10, 1, 0, 3), (w.ACCESS, 10, 1, 3, 3), (w.ACCESS, 10, 1, 3, 7)]


@pytest.mark.parametrize("nbytes", [1, 4, 33, 640])
@pytest.mark.parametrize("shift", range(3))
def test_a_copy_moves_its_bytes_and_no_others(bench: Bench, tape: Tape, nbytes: int, shift: int) -> None:
    """Wherever they lie."""
    arena = bench.memories.arena
    arena[:4096] = np.arange(4096) % 251
    before = arena[:4096].copy()
    copy = ring(tape, NO_PLAN, (9, 100, 2048 + shift, 77, nbytes)).copy
    assert [copy(1), copy(0), copy(1)] == [0, w.NONE, 1]
    before[2048 + shift : 2048 + shift + nbytes] = before[100 : 100 + nbytes]
    assert np.array_equal(arena[:4096], before)
    assert noted(tape) == 2 * [(w.COPY, 9, 100, 2048 + shift, 77)]


def test_a_wait_counts_back_from_the_last_copy(tape: Tape) -> None:
    """As the bus looks for copies; also in a later stretch."""
    lines = ring(tape, (9, 0, 64, 0, 4))
    for _ in range(3):
        lines.copy(0)
    tape.clear()
    lines.wait(1)
    assert noted(tape) == [(w.AWAIT, 2, w.RING_FULL, 5, 0)]


def test_a_line_is_taken_and_sent_as_step_by_step(bench: Bench) -> None:
    """The next one is on its way then, and the last has none behind it."""
    at_once, by_steps = taking(bench, 0), taking(bench, CORE)
    copies = [(plan, 100 * plan, 2048 + 100 * plan, 0, 64) for plan in range(3)]
    one, other = ring(at_once, *copies), ring(by_steps, *copies)
    taken, sent = ring_words(2, 1), ring_words(2, 2)
    sent[DONE] = 2
    assert [one.fetch(addressof(taken)) for _ in copies] == [0, 1, 0]
    assert one.send(addressof(sent)) == 0
    by_steps.note(*MEET)
    other.program()
    came = other.copy(0)
    for number in (1, 2):
        following = other.copy(number)
        other.wait(came)
        by_steps.note(*MEET)
        other.program()
        came = following
    other.wait(came)
    other.program()
    other.copy(2)
    assert noted(at_once) == noted(by_steps)
    assert PROGRAM in noted(at_once)


def test_a_line_without_a_plan_is_neither_taken_nor_sent(tape: Tape) -> None:
    """Nor one behind the last; nothing is noted."""
    lines, words = ring(tape, (9, 0, 64, 0, 4), NO_PLAN), ring_words(3, 3)
    for words[DONE], takes in (
        (0, (lines.fetch,)),
        (1, (lines.fetch, lines.send)),
        (2, (lines.fetch, lines.send)),
    ):
        before = bytes(words)
        assert {take(addressof(words)) for take in takes} == {w.NONE}
        assert bytes(words) == before
    assert not tape.noted


def test_a_core_in_step_notes_no_line(tape: Tape) -> None:
    """Its rings do it step by step."""
    lines, words = ring(tape, (9, 0, 64, 0, 4)), ring_words(2, 2)
    tape.takes_calls = False
    before = bytes(words)
    assert {take(addressof(words)) for take in (lines.fetch, lines.row, lines.send)} == {w.NONE}
    assert not tape.noted
    assert bytes(words) == before


def test_a_row_is_waited_for_once_its_line_was_sent(tape: Tape) -> None:
    """By the latest of the lines that it had: of two rows that of the second line before."""
    lines, words = ring(tape, *(5 * [(9, 0, 64, 0, 4)])), ring_words(2, 2)
    at, rows = addressof(words), []
    for _ in range(5):
        rows.append(lines.row(at))
        assert lines.send(at) == rows[-1]
    assert rows == [0, 1, 0, 1, 0]
    waits = [each for each in noted(tape) if each[0] == w.AWAIT]
    assert waits == 3 * [(w.AWAIT, 2, w.RING_FULL, 5, 0)]


def test_cores_have_tapes_of_their_own(bench: Bench, tape: Tape) -> None:
    """Side by side in the state."""
    other = bench.bus.tape(0)
    tape.note(*MEET)
    assert (other.noted, tape.noted) == (0, 1)


def test_a_tape_is_full_with_room_to_spare(tape: Tape) -> None:
    """So that a core need not meet the others at every operation."""
    for _ in range(MOST_OPERATIONS):
        tape.note(*MEET)
    assert not tape.is_full
    tape.note(*MEET)
    assert tape.is_full
    assert tape.noted < w.MAX_OPERATIONS
    tape.clear()
    assert not tape.is_full
