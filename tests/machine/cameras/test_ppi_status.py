"""PPI_STATUS: what sets a bit, that it stays, and that a read clears it."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.chip.ppi_registers import PpiStatusBit
from bfsim.machine.cameras.ppi_status import PpiStatus

FRAME_LINES, LINE_SAMPLES = 4, 16
FT_ERR, OVR = PpiStatusBit.FT_ERR, PpiStatusBit.OVR


def after_frames(*lines: int) -> PpiStatus:
    """Return the status after frames of so many lines and the sync that ends the last."""
    status = PpiStatus("PPI1", FRAME_LINES, LINE_SAMPLES)
    status.frame_sync()
    for count in lines:
        for _ in range(count):
            status.lines(1, LINE_SAMPLES)
        status.frame_sync()
    return status


@pytest.mark.parametrize(("lines", "word"), [(3, 0x0800), (4, 0), (5, 0)])
def test_frame_track_error_when_the_sync_comes_too_early(lines: int, word: int) -> None:
    """One line too few is an error; what comes after the last one is not looked at."""
    assert after_frames(lines).read() == word


def test_the_message_names_bit_and_register() -> None:
    """And what the register asked for, and what came."""
    status = after_frames(4, 1)
    assert status.causes == {FT_ERR: "PPI1_STATUS FT_ERR: a frame must have PPI_FRAME = 4 lines, not 1"}


def test_the_next_frame_is_counted_from_its_start() -> None:
    """A short frame spoils itself and no other."""
    assert after_frames(1).read() == FT_ERR
    status = after_frames(1, 4)
    status.read()
    for _ in range(FRAME_LINES):
        status.lines(1, LINE_SAMPLES)
    status.frame_sync()
    assert status.read() == 0


def test_nothing_is_taken_before_the_first_sync() -> None:
    """The PPI is enabled in the middle of a frame: it waits for the next one, and that is no error."""
    status = PpiStatus("PPI0", FRAME_LINES, LINE_SAMPLES)
    assert [status.lines(1, LINE_SAMPLES) for _ in range(3)] == [0, 0, 0]
    status.frame_sync()
    assert status.read() == 0
    assert status.lines(1, LINE_SAMPLES) == LINE_SAMPLES


def test_lines_beyond_the_frame_are_not_taken() -> None:
    """PPI_FRAME lines a frame, and no more until the next sync."""
    status = after_frames()
    assert [status.lines(1, LINE_SAMPLES) for _ in range(6)] == [16, 16, 16, 16, 0, 0]


@pytest.mark.parametrize(
    ("samples", "taken", "word"), [(15, 15, 0x0800), (16, 16, 0), (17, 16, 0), (0, 0, 0x0800)]
)
def test_a_line_with_too_few_samples(samples: int, taken: int, word: int) -> None:
    """What a line has beyond PPI_COUNT + 1 is cut off: that is how a part of a picture is taken."""
    status = after_frames()
    assert status.lines(1, samples) == taken
    assert status.read() == word


def test_a_short_line_is_named() -> None:
    """Lines are counted from 0."""
    status = after_frames()
    status.lines(1, LINE_SAMPLES)
    status.lines(1, 10)
    assert (
        status.causes[FT_ERR]
        == "PPI1_STATUS FT_ERR: a line must have PPI_COUNT + 1 = 16 samples, not 10 (line 1)"
    )


def test_a_read_clears_every_bit() -> None:
    """As on the BF561; other Blackfins want ones written."""
    status = after_frames(3)
    status.overrun(lost_samples=7)
    assert status.read() == FT_ERR | OVR == 0x1800
    assert status.causes == {}
    assert status.read() == 0


def test_a_bit_keeps_its_first_cause_until_it_is_read() -> None:
    """What went wrong first explains the rest."""
    status = after_frames()
    status.overrun(lost_samples=7)
    status.overrun(lost_samples=900)
    assert status.causes[OVR] == (
        "PPI1_STATUS OVR: the FIFO must be emptied in time, but 7 samples found no room in it"
    )
    status.read()
    status.overrun(lost_samples=900)
    assert "900 samples" in status.causes[OVR]


@given(st.lists(st.integers(0, 2 * FRAME_LINES), max_size=20))
def test_an_error_exactly_when_a_frame_was_short(frames: list[int]) -> None:
    """Whatever comes, the PPI never takes more lines than it was told, and reports every short frame."""
    status, taken, short = after_frames(), [], []
    for lines in frames:
        taken.append(status.lines(lines, LINE_SAMPLES) // LINE_SAMPLES)
        status.frame_sync()
        short.append(status.read() == FT_ERR)
    assert taken == [min(lines, FRAME_LINES) for lines in frames]
    assert short == [lines < FRAME_LINES for lines in frames]
