"""The SDRAM, rule by rule: no command comes too early, and none later than it must. All times are in SCLK."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.boards import CM_BF561, CM_BF561_RATINGS
from bfsim.chip.spec import BoardSpec, SdramSpec
from bfsim.machine.bus import state as w
from bfsim.machine.bus.sdram import access, hits_ahead, new_sdram, stream
from tests.machine.bus.naive_sdram import NaiveSdram

CLASSES = ("hit", "miss", "conflict")
PAGE, OTHER_PAGE, OTHER_BANK = 0, CM_BF561.sdram.page_bytes, CM_BF561.sdram.bank_bytes
READ, WRITE = False, True
SDRAM = CM_BF561.sdram
REFRESH_DUE = 1875  # 64 ms / 4096 at 120 MHz
LATE = 100  # long after everything before


class Chip:
    """The SDRAM of a board, in cycles instead of ticks."""

    def __init__(self, board: BoardSpec = CM_BF561, **sdram: int) -> None:
        """`sdram`: fields of the part that are other than the board's."""
        self.board = replace(board, sdram=replace(board.sdram, **sdram))
        self.state = new_sdram(self.board)
        self._sclk_ticks = self.board.clocks.sclk_ticks

    def access(self, now: int, offset: int, write: bool) -> int:
        """Access a word, not before cycle `now`; return when it is through."""
        ticks = access(self.state, now * self._sclk_ticks, offset, write)
        assert ticks % self._sclk_ticks == 0
        return ticks // self._sclk_ticks

    def probe(self, now: int, offset: int, write: bool) -> int:
        """Return when that access would be through, and leave everything as it is."""
        kept = self.state.copy()
        through = self.access(now, offset, write)
        self.state = kept
        return through

    @property
    def page_class(self) -> str:
        """What the last access met."""
        return CLASSES[self.state[w.PAGE_CLASS]]


def assert_earliest(chip: Chip, begin: int, offset: int, write: bool, through: int) -> None:
    """Its first command cannot be given before cycle `begin`, however early it is asked for, and can be given then.

    Asked for at that cycle it is through at `through`; asked for a cycle later it is through a cycle later.
    """
    for early in (0, begin // 2, begin - 1, begin):
        assert chip.probe(max(0, early), offset, write) == through
    assert chip.probe(begin + 1, offset, write) == through + 1


@pytest.fixture(params=[CM_BF561, CM_BF561_RATINGS], ids=lambda board: board.name)
def chip(request: Any) -> Chip:
    """A fresh SDRAM at 120 and at 133 1/3 MHz: its registers hold cycles, which are the same."""
    return Chip(request.param)


def test_a_closed_bank_is_activated_first(chip: Chip) -> None:
    """tRCD, then CL, then the word."""
    assert_earliest(chip, 0, PAGE, READ, SDRAM.nRCD + SDRAM.nCL + 1)
    assert_earliest(chip, 0, PAGE, WRITE, SDRAM.nRCD + 1)
    chip.access(0, PAGE, READ)
    assert chip.page_class == "miss"


def test_an_open_page_is_read_after_its_latency(chip: Chip) -> None:
    """CL cycles and the word; the command itself can follow the one before a cycle later."""
    chip.access(0, PAGE, READ)
    assert_earliest(chip, SDRAM.nRCD + 1, PAGE + 4, READ, SDRAM.nRCD + 1 + SDRAM.nCL + 1)
    assert chip.probe(LATE, PAGE + 4, READ) == LATE + SDRAM.nCL + 1
    assert chip.probe(LATE, PAGE + 4, WRITE) == LATE + 1


def test_another_page_is_opened_after_a_precharge(chip: Chip) -> None:
    """Long after everything else tRP and tRCD remain."""
    chip.access(0, PAGE, READ)
    assert chip.access(LATE, OTHER_PAGE, READ) == LATE + SDRAM.nRP + SDRAM.nRCD + SDRAM.nCL + 1
    assert chip.page_class == "conflict"


def test_a_page_stays_open_for_tras(chip: Chip) -> None:
    """Precharge comes nRAS after the activation, here at cycle 50, not before."""
    activated = 50
    chip.access(activated, PAGE, READ)
    precharge = activated + SDRAM.nRAS
    opened = precharge + SDRAM.nRP + SDRAM.nRCD
    assert_earliest(chip, precharge, OTHER_PAGE, READ, opened + SDRAM.nCL + 1)


def times_with(**registers: int) -> list[int]:
    """When five accesses are through: a miss, a conflict at once, a hit, a conflict later, a conflict behind a write."""
    chip = Chip(**registers)
    found = [chip.access(0, PAGE, READ)]
    found += [
        chip.probe(now, offset, READ) for now, offset in ((0, OTHER_PAGE), (LATE, PAGE), (LATE, OTHER_PAGE))
    ]
    chip.access(LATE, PAGE, WRITE)
    return [*found, chip.access(LATE, OTHER_PAGE, READ)]


@pytest.mark.parametrize(
    ("register", "is_delayed"),
    [
        ("nCL", (1, 1, 1, 1, 1)),
        ("nRCD", (1, 1, 0, 1, 1)),
        ("nRP", (0, 1, 0, 1, 1)),
        ("nRAS", (0, 1, 0, 0, 0)),
        ("nWR", (0, 0, 0, 0, 1)),
    ],
)
@pytest.mark.parametrize("more", [1, 2])
def test_each_register_delays_what_it_is_for(register: str, is_delayed: tuple[int, ...], more: int) -> None:
    """A cycle more in a field of EBIU_SDGCTL makes the accesses that it limits a cycle later, and no others."""
    longer = times_with(**{register: getattr(SDRAM, register) + more})
    delays = [after - before for after, before in zip(longer, times_with(), strict=True)]
    assert delays == [more * each for each in is_delayed]


def test_a_write_is_given_time_to_recover(chip: Chip) -> None:
    """Precharge comes nWR after the last data of a write; a read needs no such time."""
    chip.access(0, PAGE, READ)
    written = chip.access(LATE, PAGE, WRITE)
    assert written == LATE + 1
    precharge = written + SDRAM.nWR
    opened = precharge + SDRAM.nRP + SDRAM.nRCD
    assert_earliest(chip, precharge, OTHER_PAGE, READ, opened + SDRAM.nCL + 1)


def test_the_recovery_of_one_bank_keeps_no_other_waiting(chip: Chip) -> None:
    """Another bank can be activated right behind the write."""
    written = chip.access(0, PAGE, WRITE)
    assert_earliest(chip, written, OTHER_BANK, WRITE, written + SDRAM.nRCD + 1)


@pytest.mark.parametrize("write", [READ, WRITE])
def test_words_of_one_direction_follow_each_other_a_cycle_apart(chip: Chip, write: bool) -> None:
    """Neither the latency nor the page costs anything after the first word."""
    first = chip.access(0, PAGE, write)
    assert [chip.access(0, PAGE + 4 * n, write) for n in range(1, 6)] == list(range(first + 1, first + 6))
    assert chip.page_class == "hit"


def test_the_data_bus_turns_round_between_a_read_and_a_write(chip: Chip) -> None:
    """The write's data come a turn-round after the read's; its command cannot be given earlier."""
    read = chip.access(0, PAGE, READ)
    begin = read + SDRAM.turn_round_sclk
    assert_earliest(chip, begin, PAGE, WRITE, begin + 1)


def test_a_read_follows_a_write_at_once(chip: Chip) -> None:
    """Its data come CL later anyway."""
    written = chip.access(0, PAGE, WRITE)
    assert_earliest(chip, written, PAGE, READ, written + SDRAM.nCL + 1)


def test_banks_keep_their_pages_apart(chip: Chip) -> None:
    """What happens in one bank leaves the open pages of the others alone."""
    found = []
    for _ in range(2):
        for bank in range(SDRAM.banks):
            chip.access(0, bank * OTHER_BANK, READ)
            found.append(chip.page_class)
    assert found == ["miss"] * 4 + ["hit"] * 4


def test_a_refresh_that_is_not_due_disturbs_nobody() -> None:
    """The last cycle before it is still a hit; the next one meets the refresh, and a closed bank."""
    chip = Chip()
    chip.access(0, PAGE, READ)
    assert chip.probe(REFRESH_DUE - 1, PAGE, READ) == REFRESH_DUE - 1 + SDRAM.nCL + 1
    begin = REFRESH_DUE + SDRAM.refresh_sclk
    miss_sclk = SDRAM.nRCD + SDRAM.nCL + 1
    for now in (REFRESH_DUE, REFRESH_DUE + 1, begin - 1, begin):
        assert chip.probe(now, PAGE, READ) == begin + miss_sclk
    assert chip.probe(begin + 1, PAGE, READ) == begin + 1 + miss_sclk


def test_a_refresh_closes_every_bank() -> None:
    """All four have a page open, and are found closed."""
    chip = Chip()
    for bank in range(SDRAM.banks):
        chip.access(0, bank * OTHER_BANK, READ)
    classes = []
    for bank in range(SDRAM.banks):
        chip.access(REFRESH_DUE + LATE, bank * OTHER_BANK, READ)
        classes.append(chip.page_class)
    assert classes == ["miss"] * 4
    assert chip.state[w.REFRESHES] == 1


def test_a_refresh_waits_for_the_data_before_it() -> None:
    """A read whose data are under way when it gets due keeps it waiting; what comes next waits for both."""
    chip = Chip()
    chip.access(0, PAGE, READ)
    through = chip.access(REFRESH_DUE - 1, PAGE, READ)
    begin = through + SDRAM.refresh_sclk
    assert_earliest(chip, begin, PAGE, WRITE, begin + SDRAM.nRCD + 1)


@pytest.mark.parametrize("missed", [1, 2, 7])
def test_refreshes_in_idle_time_cost_nothing_and_are_not_forgotten(missed: int) -> None:
    """Of several that were due while nobody asked for anything only the last one can still be felt."""
    chip = Chip()
    chip.access(0, PAGE, READ)
    last = (missed + 1) * REFRESH_DUE
    assert chip.probe(last - 1, PAGE, READ) == last - 1 + SDRAM.nRCD + SDRAM.nCL + 1
    assert chip.access(last + 1, PAGE, READ) == last + SDRAM.refresh_sclk + SDRAM.nRCD + SDRAM.nCL + 1
    assert chip.state[w.REFRESHES] == missed + 1
    assert chip.state[w.NEXT_REFRESH] == chip.board.clocks.sclk_ticks * (missed + 2) * REFRESH_DUE


@pytest.mark.parametrize("board", [CM_BF561, CM_BF561_RATINGS], ids=lambda board: board.name)
def test_refresh_interval(board: BoardSpec) -> None:
    """64 ms for 4096 rows, in whole cycles of SCLK."""
    state = new_sdram(board)
    expected = {120_000_000: 1875, 133_333_333: 2083}[int(board.clocks.sclk_hz)]
    assert state[w.REFRESH_INTERVAL] == expected * board.clocks.sclk_ticks


@pytest.mark.parametrize("write", [READ, WRITE])
def test_the_precharge_of_a_refresh_waits_as_any_other(write: bool) -> None:
    """A bank that was activated or written a moment ago cannot be precharged yet, for a refresh neither."""
    chip = Chip()
    activated = REFRESH_DUE - 1
    through = chip.access(activated, PAGE, write)
    earliest = activated + SDRAM.nRAS
    if write:
        earliest = max(earliest, through + SDRAM.nWR)
    begin = max(earliest, through) + SDRAM.refresh_sclk
    assert chip.access(0, PAGE, READ) >= begin + SDRAM.nRCD + SDRAM.nCL + 1


# ---- Beside the naive model

parts = st.builds(
    lambda nCL, nRCD, nRP, nRAS, nWR, turn, rows: replace(
        SDRAM,
        nCL=nCL,
        nRCD=nRCD,
        nRP=nRP,
        nRAS=nRAS,
        nWR=nWR,
        turn_round_sclk=turn,
        rows_refreshed=rows,
    ),
    st.integers(2, 3),
    st.integers(1, 7),
    st.integers(1, 7),
    st.integers(1, 15),
    st.integers(1, 3),
    st.integers(0, 2),
    st.sampled_from([4096, 120_000, 76_800]),  # a refresh every 1875, 64 and 100 cycles
)
# wait since the last request, bank, page, word, whether it writes
requests = st.lists(
    st.tuples(
        st.one_of(st.integers(0, 3), st.integers(0, 200)),
        st.integers(0, 3),
        st.integers(0, 2),
        st.integers(0, 3),
        st.booleans(),
    ),
    max_size=60,
)


@given(part=parts, asked=requests)
def test_words_meet_what_the_naive_model_says(
    part: SdramSpec, asked: list[tuple[int, int, int, int, bool]]
) -> None:
    """Whatever the part and the stream, the compiled rules give every word the same cycle and page class."""
    board = replace(CM_BF561, sdram=part)
    chip = Chip(board)
    naive = NaiveSdram(part, part.refresh_interval_sclk(board.clocks.sclk_hz))
    now = 0
    for wait, bank, page, word, write in asked:
        now += wait
        offset = bank * part.bank_bytes + page * part.page_bytes + 4 * word
        expected = naive.access(now, offset, write=write)
        assert (chip.access(now, offset, write), chip.page_class) == expected
    assert chip.state[w.REFRESHES] == naive.refreshes


@given(offset=st.integers(0, 4095).map(lambda n: 4 * n), count=st.integers(1, 600), write=st.booleans())
def test_a_stream_of_hits_is_what_its_words_are(offset: int, count: int, write: bool) -> None:
    """Done at once or word by word, the state afterwards is the same, and `hits_ahead` says how many there are."""
    one_by_one, at_once = Chip(), Chip()
    for chip in (one_by_one, at_once):
        chip.access(0, offset, write)
    ahead = hits_ahead(at_once.state, offset + 4, 4, 4096)
    assert ahead == (SDRAM.page_bytes - 4 - offset % SDRAM.page_bytes) // 4
    assert hits_ahead(at_once.state, offset + 4, 4, count) == min(count, ahead)
    count = min(count, ahead)
    stream(at_once.state, count, write, offset)
    for word in range(count):
        one_by_one.access(0, offset + 4 * (word + 1), write)
        assert one_by_one.page_class == "hit"
    told = slice(w.COMMAND_FREE, w.PAGE_CLASS), slice(w.OPEN_PAGE, w.SDRAM_WORDS)
    assert all(np.array_equal(one_by_one.state[each], at_once.state[each]) for each in told)
