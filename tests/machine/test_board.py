"""A whole board: what a run reports, how it ends, and how much the simulation has to do for it."""

from __future__ import annotations

import signal
from collections.abc import Generator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bfsim.api import BudgetRow, Buffer, Core, Firmware, Frame, FrameSize, i16, u8
from bfsim.chip.boards import BOARDS, board_named
from bfsim.errors import ConfigError, FirmwareError, LinkError
from bfsim.linker import LinkMap
from bfsim.machine.board import Board
from bfsim.machine.cameras.capture import Feed
from bfsim.trace import BoardRecord, FrameRecord
from tests.machine.kernels import copy, first, spin
from tests.machine.rig import (
    SIZE,
    STAGES,
    Picture,
    Play,
    board_of,
    buffers,
    cycles_of,
    every_frame,
    load,
    noise,
    of_core,
    run,
    see_all,
    through_rings,
)


def in_and_out(core: Core, frame: Frame) -> Play:
    """A stage as firmware has them: lines in, a kernel a line, lines out."""
    with core.stage(STAGES[0]):
        yield from through_rings(core, frame, copy)


def test_frames_are_reported_as_soon_as_both_cores_are_done() -> None:
    """Core A is fast; a frame is handed out when B has finished it, in order, and all are in the outcome."""
    heard: list[FrameRecord] = []

    def slow(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 3_000_000)

    board = load(see_all, every_frame(slow))
    outcome = board.run(iter(noise(5)), heard.append)
    assert tuple(heard) == outcome.frames
    assert [each.index for each in heard] == [0, 1, 2, 3, 4]
    assert [each.core for frame in heard for each in frame.cores] == ["A", "B"] * 5
    assert all(of_core(each, "B").end_cclk == each.result_cclk for each in heard)


def test_the_slower_core_makes_the_frame_late_and_the_faster_one_runs_ahead() -> None:
    """A takes the next picture while B is still at this one: their frames overlap in time."""

    def slow(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 3_000_000)

    frames = run(see_all, every_frame(slow), frames=3).frames
    assert of_core(frames[1], "A").end_cclk < of_core(frames[0], "B").end_cclk + cycles_of(spin, 3_000_000)


def test_a_recording_at_its_own_pace_tells_what_was_missed() -> None:
    """Work of more than 60 ms against a picture each 40: every frame is in one of the lists, in none twice."""

    def work(core: Core, frame: Frame) -> Play:
        yield core.run(spin, 8_000_000)

    assert cycles_of(spin, 8_000_000) > 36_000_000
    outcome = run(every_frame(work), frames=noise(12, period_ns=40_000_000), feed=Feed.RECORDED)
    delivered = [each.index for each in outcome.frames]
    assert outcome.missed
    assert sorted([*delivered, *outcome.missed]) == list(range(12))
    assert delivered == sorted(delivered)


@pytest.mark.parametrize("board", [name for name, each in BOARDS.items() if len(each.chip.cores) == 2])
def test_traffic_adds_up(board: str) -> None:
    """Both cameras, both streams of both cores: bytes in are bytes out, three frames long."""
    outcome = run(every_frame(in_and_out), every_frame(in_and_out), frames=3, board=board)
    nbytes = 3 * SIZE.height_px * 2 * SIZE.width_px
    moved = {
        each.master: (each.read_bytes, each.written_bytes)
        for each in outcome.traffic
        if each.memory == "SDRAM"
    }
    assert moved == {
        "PPI0": (0, nbytes),
        "PPI1": (0, nbytes),
        "MDMA1 stream 0": (nbytes, 0),
        "MDMA1 stream 1": (0, nbytes),
        "MDMA2 stream 0": (nbytes, 0),
        "MDMA2 stream 1": (0, nbytes),
    }
    last_cclk = outcome.frames[-1].result_cclk
    assert sum(each.busy_cclk for each in outcome.traffic) <= last_cclk


def test_events_are_a_few_per_line() -> None:
    """SimPy carries lines, never pixels: per core and line the camera's, the DMA's and the core's own events."""
    size = FrameSize(64, 48)
    few, many = (
        run(every_frame(in_and_out), every_frame(in_and_out), frames=n, size=size).events for n in (2, 12)
    )
    assert (many - few) / 10 <= 2 * (48 * 6 + 20)


def test_events_do_not_grow_with_the_width() -> None:
    """Twice the pixels in a line are no more events."""
    narrow, wide = (run(every_frame(in_and_out), size=FrameSize(width, 24)).events for width in (32, 64))
    assert wide <= narrow * 1.1


class Interrupting:
    """Firmware that is interrupted in a given frame, as if Ctrl-C was pressed then."""

    def __init__(self, frame: int, how: Any) -> None:
        self.frame = frame
        self.how = how

    def __call__(self, core: Core, frame: Frame) -> Generator[Any, Any, None]:
        yield core.run(spin, 10)
        if frame.index == self.frame:
            self.how()
        yield core.run(spin, 10)


def raise_it() -> None:
    """The exception that a kernel call or a generator sees."""
    raise KeyboardInterrupt


def press_it() -> None:
    """The signal itself."""
    signal.raise_signal(signal.SIGINT)


@pytest.mark.parametrize("how", [raise_it, press_it])
@pytest.mark.parametrize("core", ["A", "B"])
def test_ctrl_c_reports_the_frames_done(core: str, how: Any) -> None:
    """Interrupted in the middle of frame 3: frames 0 to 2 are there, complete, and the outcome says so."""
    mains = [every_frame(Interrupting(3, how)), see_all]
    outcome = run(*(mains if core == "A" else mains[::-1]), frames=10)
    assert outcome.interrupted
    assert [each.index for each in outcome.frames] == [0, 1, 2]


def test_after_ctrl_c_no_core_begins_anything() -> None:
    """What it began might not end: Ctrl-C and SIGTERM ended the endless loop of one core, and the other one went into its own."""
    began = []

    def interrupted(core: Core) -> Generator[Any, Any, None]:
        press_it()
        yield from core.next_frame()

    def other(core: Core) -> Generator[Any, Any, None]:
        began.append(core.name)
        yield from core.next_frame()

    outcome = run(interrupted, other, frames=1)
    assert (outcome.interrupted, outcome.frames, began) == (True, (), [])


def test_a_kernel_that_began_in_the_interrupted_frame_is_in_no_record() -> None:
    """Records are of the frames that are done."""

    def late(core: Core, frame: Frame) -> Generator[Any, Any, None]:
        yield core.run(spin, 10)
        if frame.index == 2:
            yield core.run(first, core.rows("single_row")[0])
            raise KeyboardInterrupt

    outcome = run(every_frame(late), frames=3)
    assert len(outcome.frames) == 2
    assert [(each.kernel, each.calls) for each in outcome.kernels] == [("spin", 2)]
    assert not outcome.accesses


def test_ctrl_c_while_the_recording_is_read_reports_the_frames_done() -> None:
    """Reading takes most of a long run's time; it is interrupted there as well."""

    def pressed() -> Any:
        yield from noise(3)
        raise KeyboardInterrupt

    outcome = run(every_frame(in_and_out), frames=pressed())
    assert outcome.interrupted
    assert [each.index for each in outcome.frames] in ([0], [0, 1], [0, 1, 2])


def test_a_run_to_the_end_is_not_interrupted() -> None:
    """Nothing missed, nothing interrupted."""
    outcome = run(see_all, frames=2)
    assert not outcome.interrupted
    assert outcome.missed == ()


def test_two_boards_in_one_process_know_nothing_of_each_other() -> None:
    """The second run has the numbers of the first: no state stays behind."""

    def outcome() -> BoardRecord:
        return replace(run(every_frame(in_and_out), every_frame(in_and_out), frames=2), kernels=())

    assert outcome() == outcome()


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


def test_errors_of_the_recording_come_through() -> None:
    """A frame that cannot be read ends the run with the reader's own words, not with an outcome."""

    def torn() -> Any:
        yield next(noise(1))
        raise ConfigError("drive.mcap: chunk 3 must be whole, not torn")

    with pytest.raises(ConfigError, match="chunk 3 must be whole"):
        run(every_frame(in_and_out), frames=torn())


def test_frames_keep_the_recording_s_own_numbers() -> None:
    """A recording may be cut: what starts at frame 40 is reported as frame 40."""
    frames = [
        Picture(each.index + 40, each.left, each.right, each.left_ns, each.right_ns) for each in noise(2)
    ]
    assert [each.index for each in run(see_all, frames=frames).frames] == [40, 41]
