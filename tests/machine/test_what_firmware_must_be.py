"""What firmware must be for a board to run it, and what its buffers hold."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bfsim.api import BudgetRow, Buffer, Core, Firmware, Frame, FrameSize, i16, u8
from bfsim.chip.boards import board_named
from bfsim.errors import FirmwareError, LinkError
from bfsim.linker import LinkMap
from bfsim.machine.board import Board
from bfsim.trace import BoardRecord
from tests.machine.rig import (
    SIZE,
    Play,
    board_of,
    buffers,
    every_frame,
    noise,
    run,
    see_all,
)


def firmware(**changes: Any) -> Firmware:
    """Return firmware that sees every picture, changed as said."""
    return replace(
        Firmware(mains={"A": see_all, "B": see_all}, buffers=buffers, camera="camera", rows=()), **changes
    )


def camera_of(*camera: Buffer) -> Any:
    """Make the buffers of firmware whose cores have this camera buffer only."""
    return lambda size: {"A": camera, "B": camera}


@pytest.mark.parametrize(
    ("program", "message"),
    [
        (
            firmware(camera="kamera"),
            "camera buffer 'kamera' of each core must have a multiple of 8 rows of 32 bytes; there is none of that name for A, B",
        ),
        (
            firmware(buffers=camera_of(Buffer("camera", u8, 32, "L1_data_a", rows=7))),
            "must have a multiple of 8 rows of 32 bytes, not 7 rows of 32 bytes$",
        ),
        (
            firmware(buffers=camera_of(Buffer("camera", u8, 30, "L1_data_a", rows=8))),
            "of 32 bytes, not 8 rows of 30 bytes$",
        ),
        (firmware(buffers=lambda size: {"C": ()}), "buffers must belong to A, B, shared, not 'C'"),
    ],
)
def test_firmware_that_does_not_fit_the_board_is_refused(program: Firmware, message: str) -> None:
    """Before the first picture, with the name of what is wrong."""
    with pytest.raises(FirmwareError, match=message):
        board_of(program).run(iter(noise(1)))


def test_numbers_of_a_reference_need_a_word_about_it() -> None:
    """Milliseconds of unknown origin are not reported."""
    with pytest.raises(FirmwareError, match="reference must say what the reference_ms of Work is"):
        firmware(rows=(BudgetRow(stage="Work", reference_ms=3.5),))


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        (
            (BudgetRow(stage="Work"), BudgetRow(stage="Work")),
            "rows must have each stage once, not Work twice",
        ),
        ((BudgetRow(stage="(the rest)"),), r"the stage of a row must not be \(the rest\), which is what no"),
        ((BudgetRow(stage="Work", within="Work"),), "Work must be within another row, .* not within 'Work'"),
        ((BudgetRow(stage="Work", within="Play"),), "Work must be within another row, .* not within 'Play'"),
        (
            (BudgetRow(stage="a"), BudgetRow(stage="b", within="a"), BudgetRow(stage="c", within="b")),
            "c must be within another row, which is in none itself, not within 'b'",
        ),
        *(
            ((BudgetRow(stage=each),), f"must not be {each}, which `bfsim check` calls something else; [A-Z]")
            for each in ("frame", "memory", "results")
        ),
        ((BudgetRow(stage=" "),), "must be a name on one line without quotes, not ' '"),
        ((BudgetRow(stage="a\nb"),), r"must be a name on one line without quotes, not 'a\\nb'"),
        ((BudgetRow(stage='"a"'),), "must be a name on one line without quotes, not '\"a\"'"),
        (("Work",), "rows must be of BudgetRow, not 'Work'"),
    ],
)
def test_rows_that_no_budget_can_have_are_refused(rows: Any, message: str) -> None:
    """A stage in two rows was counted twice, and one called as what no stage has made frames twice as long."""
    with pytest.raises(FirmwareError, match=message):
        firmware(rows=rows)


@pytest.mark.parametrize(
    ("part", "message"),
    [
        (
            {"mains": [see_all, see_all]},
            'mains of a firmware must be a dict of the main loops by core, such as {"A": main',
        ),
        (
            {"mains": {"A": see_all, "B": None}},
            "mains of a firmware must be a dict of the main loops by core",
        ),
        (
            {"buffers": {"A": []}},
            "buffers of a firmware must be a function that takes the size of the pictures, not",
        ),
        ({"camera": 3}, "camera of a firmware must be the name of a buffer, not 3"),
        ({"rows": BudgetRow(stage="Work")}, "rows of a firmware must be a tuple of BudgetRow, not BudgetRow"),
        ({"reference": 3}, "reference of a firmware must be a Reference or None, not 3"),
        ({"calibration": 3}, "calibration of a firmware must be a function or None, not 3"),
        ({"view": 3}, "view of a firmware must be a function or None, not 3"),
        (
            {"losses": ["lost"]},
            "losses of a firmware must be a dict of words by the name of what is published, not",
        ),
        ({"assumed_geometry": 3}, "assumed_geometry of a firmware must be words, not 3"),
        (
            {"write_through": "MEM_SDRAM"},
            "write_through of a firmware must be a tuple of names of segments, not",
        ),
    ],
)
def test_parts_of_another_kind_are_refused(part: dict[str, Any], message: str) -> None:
    """Where firmware is made, with its line; five of them ended in a traceback later, and others were told without a place."""
    with pytest.raises(FirmwareError, match=message):
        replace(firmware(), **part)


def test_buffers_that_cannot_be_are_told_with_their_line() -> None:
    """The name of an element in place of the element."""

    def buffers(_size: FrameSize) -> Any:
        return {"A": [Buffer("camera", "u8", 8, "sdram_bank0")]}  # type: ignore[arg-type]

    line = buffers.__code__.co_firstlineno + 1
    with pytest.raises(
        FirmwareError, match=rf"must have elements of i8 to u32 or f32, not 'u8' \({__file__}:{line}\)"
    ):
        board_of(replace(firmware(), buffers=buffers))


def test_what_no_remark_can_be() -> None:
    """No number, and nothing that a terminal obeys: half a character ended the JSON in a traceback."""

    def remark(text: Any) -> BoardRecord:
        def body(core: Core, frame: Frame) -> Play:
            core.remark(text)
            yield from ()

        return run(every_frame(body))

    with pytest.raises(FirmwareError, match=r"a remark must be text, not 3 \("):
        remark(3)
    told = remark("two\nlines \x1b[31m \udcff").frames[0].remarks[0]
    assert told == r"core A two\nlines \x1b[31m \udcff"


def test_an_iterator_that_has_ended_is_told_with_its_line() -> None:
    """Python makes another error of it, which comes from nowhere."""

    def body(core: Core, frame: Frame) -> Play:
        next(iter(()))
        yield from ()

    line = body.__code__.co_firstlineno + 1
    with pytest.raises(FirmwareError, match=rf"StopIteration \({__file__}:{line}\)"):
        run(every_frame(body))


def test_stages_without_rows_are_told_what_is_missing() -> None:
    """It was said that a stage must be one of nothing."""

    def body(core: Core, frame: Frame) -> Play:
        with core.stage("Work"):
            yield from ()

    board = board_of(replace(firmware(), mains=dict.fromkeys("AB", every_frame(body)), rows=()))
    with pytest.raises(
        FirmwareError, match="stage must be one of the firmware's rows, which has none, not 'Work'"
    ):
        board.run(iter(noise(1)))


def test_a_camera_buffer_of_16_bit_elements_holds_the_same_bytes() -> None:
    """DMA fills bytes: 16 elements of 16 bits are a line of 16 pixels."""
    seen = []

    def look(core: Core, frame: Frame) -> Play:
        seen.append(np.stack([row.array for row in frame.rows]))
        yield from ()

    program = firmware(
        buffers=camera_of(Buffer("camera", i16, 16, "L1_data_a", rows=8)),
        mains={"A": every_frame(look), "B": see_all},
    )
    board_of(program).run(iter(noise(1)))
    assert np.array_equal(seen[0], next(noise(1)).left.view(np.int16))


def test_a_board_needs_every_buffer_placed() -> None:
    """A link map of other firmware is told by the name of the symbol that it does not have."""
    with pytest.raises(LinkError, match="linked for p0, not 'camera'"):
        Board(board_named("cm-bf561"), firmware(), SIZE, LinkMap([], []))


def test_values_of_a_buffer_are_there_at_the_start() -> None:
    """Tables are part of the program's image; everything else is zero."""
    table = np.arange(6, dtype=np.int16) - 3
    seen = []

    def look(core: Core, frame: Frame) -> Play:
        seen.append([row.array.tolist() for row in core.rows("table")])
        yield from ()

    camera = Buffer("camera", u8, 32, "L1_data_a", rows=8)
    program = firmware(
        buffers=camera_of(camera, Buffer("table", i16, 3, "L1_data_b", rows=2, values=table)),
        mains={"A": every_frame(look), "B": see_all},
    )
    board_of(program).run(iter(noise(1)))
    assert seen == [[[-3, -2, -1], [0, 1, 2]]]
