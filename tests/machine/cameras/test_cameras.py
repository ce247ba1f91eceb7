"""The cameras of a whole board: when their pictures come, how they settle, and what their FIFOs lose."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from bfsim.api import Buffer, Core, FirmwareError, Frame, FrameSize, PpiStatusBit, i32
from bfsim.chip.boards import CM_BF561, board_named
from bfsim.chip.sensor_spec import SensorMode, SensorSpec
from bfsim.chip.sensors import LEFT_CAMERA, MHZ, RIGHT_CAMERA
from bfsim.chip.spec import BoardSpec
from bfsim.clocks import Clocks
from bfsim.machine.cameras.capture import Feed
from bfsim.machine.cameras.oscillator import Oscillator
from bfsim.machine.cameras.ppi import Ppi
from bfsim.machine.cameras.settling import CameraSettings, settled
from bfsim.machine.cameras.skipping import SKIPS, skipped
from bfsim.machine.dma.config import DmaConfig
from tests.machine.kernels import first, spin, total
from tests.machine.made_boards import CHIP, CLOCKS, assert_accounted, play
from tests.machine.rig import SIZE, Picture, Play, every_frame, noise, see_all

CAMERAS = {"A": LEFT_CAMERA, "B": RIGHT_CAMERA}
SETTINGS = CameraSettings(exposure_lines=200, gain=16, red_gain=128, blue_gain=128)
MODE = CM_BF561.sensor.mode(SIZE.width_px, SIZE.height_px)
QUICK = SensorMode(
    width_px=64, height_px=8, ppi_clk_hz=Fraction(60 * MHZ), line_clocks=160, frame_lines=12, lines_before=2
)
"""At the PPI's limit of SCLK / 2."""
QUICK_SIZE = FrameSize(64, 8)


def starts_of(
    monkeypatch: pytest.MonkeyPatch, frames: int, board: BoardSpec = CM_BF561
) -> dict[str, list[int]]:
    """Run the cameras at their own pace; return the tick of each picture's first byte by PPI."""
    starts: dict[str, list[int]] = {"PPI0": [], "PPI1": []}
    receive = Ppi.receive

    def noting(self: Ppi, picture: NDArray[np.uint8], rows: Any, start: int) -> Any:
        starts[self.status._name].append(start)
        return receive(self, picture, rows, start)

    monkeypatch.setattr(Ppi, "receive", noting)
    outcome = play(see_all, feed=Feed.CAMERAS, frames=frames, spec=board)
    assert (len(outcome.frames), outcome.missed) == (frames, ())
    return starts


def exact_start(frame: int, camera: Any, clocks: Clocks) -> Fraction:
    """When a picture begins: its phase, the frames before it, and the blank lines above it, at the true PPI_CLK."""
    ppi_clk_hz = MODE.ppi_clk_hz * (1 + camera.offset_ppm / MHZ)
    cycles = (camera.phase_frames + frame) * MODE.frame_clocks + MODE.lines_before * MODE.line_clocks
    return cycles / ppi_clk_hz * clocks.tick_hz


@pytest.mark.parametrize("board", ["cm-bf561", "cm-bf561-ratings"])
def test_each_camera_keeps_its_own_time(board: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Phase and pace of its oscillator, to the tick, however long it runs."""
    spec = board_named(board)
    starts = starts_of(monkeypatch, 20, spec)
    for ppi, camera in zip(starts, CAMERAS.values(), strict=True):
        oscillator = Oscillator(spec.clocks, MODE, camera)
        assert starts[ppi] == [oscillator.line_start(frame, 0) for frame in range(20)]
        for frame, start in enumerate(starts[ppi]):
            assert 0 <= start - exact_start(frame, camera, spec.clocks) < 1


def test_two_cameras_drift_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    """60 ppm between them: from the phase at the start, two microseconds more a frame of a thirtieth of a second."""
    starts = starts_of(monkeypatch, 30)
    behind = [right - left for left, right in zip(starts["PPI0"], starts["PPI1"], strict=True)]
    seconds = [each / CLOCKS.tick_hz for each in behind]
    frame_s = 1 / MODE.frame_hz
    assert float(seconds[0]) == pytest.approx(float(frame_s / 3), rel=1e-3)
    for number, each in enumerate(seconds):
        drift_s = number * frame_s * Fraction(60, MHZ)
        assert float(each - seconds[0] - drift_s) == pytest.approx(0, abs=1e-8)


def test_a_pair_is_there_when_the_later_picture_is() -> None:
    """The right camera is a third of a frame behind: its last byte, and its way into memory, end the wait."""
    outcome = play(see_all, feed=Feed.CAMERAS, frames=5)
    oscillator = Oscillator(CLOCKS, MODE, RIGHT_CAMERA)
    for number, frame in enumerate(outcome.frames):
        last_cclk = oscillator.line_end(number, SIZE.height_px - 1) // CLOCKS.cclk_ticks
        assert 0 <= frame.last_line_cclk - last_cclk < 200
    assert_accounted(outcome)


def test_cameras_do_not_wait_for_slow_firmware() -> None:
    """Work of more than two frames: in between pictures are overwritten, and told as missed; the newest is worked on."""
    frame_cclk = int(CLOCKS.cclk_hz / MODE.frame_hz)
    turns = frame_cclk * 5 // 2 // 7

    def work(core: Core, frame: Frame) -> Play:
        yield core.run(spin, turns)

    outcome = play(every_frame(work), feed=Feed.CAMERAS, frames=12)
    taken = [each.index for each in outcome.frames]
    assert sorted([*taken, *outcome.missed]) == list(range(12))
    assert 4 <= len(taken) <= 6
    assert taken == sorted(taken)


@pytest.mark.parametrize("ppi_clk_hz", [12_000_001, 53_333_333])
def test_a_camera_of_an_odd_clock_loses_no_words(ppi_clk_hz: int) -> None:
    """The ticks of its words are fractions of large numbers: a picture has more of their parts than 64 bits count."""
    size = FrameSize(64, 60)
    mode = SensorMode(
        width_px=64,
        height_px=60,
        ppi_clk_hz=Fraction(ppi_clk_hz),
        line_clocks=8000,
        frame_lines=80,
        lines_before=10,
    )
    spec = replace(CM_BF561, sensor=SensorSpec(name="odd", modes=(mode,)))
    outcome = play(see_all, feed=Feed.CAMERAS, frames=3, size=size, spec=spec)
    assert outcome.frames
    assert not any(lost_of(outcome) + lost_of(outcome, "B"))


@pytest.mark.parametrize("feed", [Feed.CAMERAS, Feed.RECORDED])
def test_pictures_that_overlap_those_of_the_other_camera_are_whole(feed: Feed) -> None:
    """The left camera begins its next picture while the right one is at its last lines."""
    got: dict[str, list[bytes]] = {"A": [], "B": []}

    def work(core: Core, frame: Frame) -> Play:
        got[core.name].append(b"".join(row.octets.tobytes() for row in frame.rows))
        yield core.run(first, frame.rows[0])

    period_ns = 1_000_000_000 // 30
    pictures = [
        replace(each, right_ns=each.right_ns + period_ns // 3) for each in noise(4, SIZE, period_ns + 1)
    ]
    play(every_frame(work), every_frame(work), frames=pictures, feed=feed)
    assert got["A"] == [each.left.tobytes() for each in pictures]
    assert got["B"] == [each.right.tobytes() for each in pictures]


# ---- settling


def flat(count: int, size: FrameSize = SIZE) -> list[Picture]:
    """Pictures of random bytes, all the same: what changes is the camera's."""
    pictures = list(noise(1, size)) * count
    return [replace(each, index=index) for index, each in enumerate(pictures)]


def seen(change_at: int, frames: int, **made: Any) -> tuple[dict[str, list[NDArray[np.uint8]]], Any]:
    """Let each core change its camera's settings at a frame; return the pictures they got, and the run."""
    got: dict[str, list[NDArray[np.uint8]]] = {"A": [], "B": []}

    def work(core: Core, frame: Frame) -> Play:
        got[core.name].append(np.array([row.array for row in frame.rows]))
        if frame.index == change_at:
            core.set_camera(SETTINGS)
        if made.get("turns"):
            yield core.run(spin, made["turns"])
        yield core.run(first, frame.rows[0])

    how = {name: value for name, value in made.items() if name != "turns"}
    outcome = play(every_frame(work), every_frame(work), frames=flat(frames), **how)
    return got, outcome


@pytest.mark.parametrize(("feed", "off"), [(Feed.DEMAND, {"A": 2, "B": 2}), (Feed.CAMERAS, {"A": 3, "B": 2})])
def test_pictures_are_off_until_new_settings_have_worked(feed: Feed, off: dict[str, int]) -> None:
    """The next ones differ, less in each; after so many frames of each camera they are as recorded again.

    At its own pace the left camera has begun its next picture by the time the right one's is there.
    """
    got, _ = seen(1, 14, feed=feed)
    (recorded,) = noise(1)
    for core, picture in (("A", recorded.left), ("B", recorded.right)):
        camera = CAMERAS[core]
        for index, each in enumerate(got[core]):
            since = index - off[core] if index >= off[core] else camera.settling_frames
            np.testing.assert_array_equal(each, settled(picture, since, camera), err_msg=f"{core} {index}")
        differ = [index for index, each in enumerate(got[core]) if (each != picture).any()]
        assert differ == list(range(off[core], off[core] + camera.settling_frames))


def test_the_same_settings_again_change_nothing() -> None:
    """Set in every frame: the camera settles once."""
    got = []

    def work(core: Core, frame: Frame) -> Play:
        got.append(np.array([row.array for row in frame.rows]))
        core.set_camera(SETTINGS)
        yield core.run(first, frame.rows[0])

    play(every_frame(work), frames=flat(10))
    (recorded,) = noise(1)
    differ = [index for index, each in enumerate(got) if (each != recorded.left).any()]
    assert differ == list(range(1, 1 + LEFT_CAMERA.settling_frames))


def test_a_camera_settles_also_while_nobody_takes_its_pictures() -> None:
    """Room for one picture and slow firmware: what goes by counts, so that fewer pictures are seen off."""
    frame_cclk = int(CLOCKS.cclk_hz / MODE.frame_hz)
    got, outcome = seen(0, 14, feed=Feed.CAMERAS, camera_frames=1, turns=frame_cclk * 3 // 2 // 7)
    (recorded,) = noise(1)
    taken = [each.index for each in outcome.frames]
    assert outcome.missed, "some go by"
    for index, each in zip(taken[1:], got["A"][1:], strict=True):  # the left one had begun picture 1
        expected = settled(recorded.left, index - 2, LEFT_CAMERA)
        np.testing.assert_array_equal(each, expected, err_msg=str(index))


# ---- smaller pictures


@given(st.integers(1, 9), st.integers(1, 5), st.sampled_from(SKIPS), st.integers(0, 3), st.integers(0, 7))
def test_a_sensor_skips_pixels_and_lines(
    height: int, pairs: int, step: int, more_lines: int, more_pixels: int
) -> None:
    """Luma of each pixel that is sent; the colour of a pair from the pair of its left one."""
    rng = np.random.default_rng(height)
    shape = height * step + min(more_lines, step - 1), 4 * (pairs * step + min(more_pixels, step - 1) // 2)
    picture = rng.integers(0, 256, shape, np.uint8)
    sent = skipped(picture, step)
    assert sent.shape[0] == height
    assert sent.shape[1] >= 4 * pairs
    for y in range(height):
        for pair in range(pairs):
            left, right = 2 * pair * step, (2 * pair + 1) * step
            u, first, v, second = sent[y, 4 * pair : 4 * pair + 4]
            line = picture[y * step]
            assert (first, second) == (line[2 * left + 1], line[2 * right + 1])
            assert (u, v) == (line[4 * (left // 2)], line[4 * (left // 2) + 2])


HALF = FrameSize(SIZE.width_px // 2, SIZE.height_px // 2)


@pytest.mark.parametrize("feed", [Feed.DEMAND, Feed.CAMERAS, Feed.RECORDED])
def test_both_cameras_send_smaller_pictures_once_both_are_told(feed: Feed) -> None:
    """The left one is told a frame earlier; pictures of both become smaller together, and are settled later."""
    got: dict[str, list[Any]] = {"A": [], "B": []}

    def work(core: Core, frame: Frame) -> Play:
        got[core.name].append(
            (frame.index, (frame.width, frame.height), np.array([row.array for row in frame.rows]))
        )
        if frame.index == (1 if core.name == "A" else 2):
            core.set_picture_size(HALF)
        yield core.run(first, frame.rows[0])

    pictures = flat(16)
    stamped = [replace(each, left_ns=each.index * 10**8, right_ns=each.index * 10**8) for each in pictures]
    outcome = play(every_frame(work), every_frame(work), frames=stamped, feed=feed)
    assert_accounted(outcome)
    for core, recorded in (("A", pictures[0].left), ("B", pictures[0].right)):
        small = [index for index, size, _ in got[core] if size == (HALF.width_px, HALF.height_px)]
        assert small[0] in (3, 4)
        assert small == list(range(small[0], 16))
        last = got[core][-1][2]
        np.testing.assert_array_equal(last, skipped(recorded, 2))
        np.testing.assert_array_equal(got[core][small[0]][2], settled(skipped(recorded, 2), 0, CAMERAS[core]))
    assert [each[:2] for each in got["A"]] == [each[:2] for each in got["B"]]


def test_cameras_keep_their_pace_when_the_size_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first smaller picture begins when it would have; from then on at the frame rate of that size."""
    starts: list[int] = []
    receive = Ppi.receive

    def noting(self: Ppi, picture: NDArray[np.uint8], rows: Any, start: int) -> Any:
        if self.status._name == "PPI0":
            starts.append(start)
        return receive(self, picture, rows, start)

    def work(core: Core, frame: Frame) -> Play:
        if frame.index == 0:
            core.set_picture_size(HALF)
        yield core.run(first, frame.rows[0])

    monkeypatch.setattr(Ppi, "receive", noting)
    play(every_frame(work), every_frame(work), frames=8, feed=Feed.CAMERAS)
    whole = Oscillator(CLOCKS, MODE, LEFT_CAMERA)
    half = Oscillator(CLOCKS, CM_BF561.sensor.mode(HALF.width_px, HALF.height_px), LEFT_CAMERA)
    assert starts[:3] == [whole.line_start(frame, 0) for frame in range(3)]
    periods = np.diff(starts[2:])
    expected = half.line_start(1, 0) - half.line_start(0, 0)
    assert abs(periods - expected).max() <= 1


@pytest.mark.parametrize(
    "size", [FrameSize(2 * SIZE.width_px, 2 * SIZE.height_px), FrameSize(SIZE.width_px, 2)]
)
def test_sizes_that_no_recorded_picture_can_have(size: FrameSize) -> None:
    """Larger than recorded, or of another shape."""

    def work(core: Core, frame: Frame) -> Play:
        core.set_picture_size(size)
        yield core.run(first, frame.rows[0])

    with pytest.raises(
        FirmwareError, match=f"pictures must be of {SIZE} or {HALF}.*, not of {size} .*test_cameras"
    ):
        play(every_frame(work))


# ---- the FIFO

STRIDE = CM_BF561.sdram.page_bytes
BLOCK = 1000
WIDE = Buffer("wide", i32, 2 * BLOCK * STRIDE // 4, "sdram_bank2")


def quick(fifo_words: int, dma_words: int = CHIP.dma.fifo_words) -> BoardSpec:
    """A board with cameras at the PPI's limit, and FIFOs of so many words beside those of the DMA channels."""
    chip = replace(CHIP, ppi_fifo_words=fifo_words, dma=replace(CHIP.dma, fifo_words=dma_words))
    return replace(CM_BF561, chip=chip, sensor=SensorSpec(name="quick", modes=(QUICK,)))


def blocked(spec: BoardSpec, *, by: str) -> tuple[Any, list[list[int]], list[Picture]]:
    """Let a memory DMA or the core open a page of SDRAM for each word while pictures come; return the run and the pictures."""
    got: list[list[int]] = []
    pictures = list(noise(3, QUICK_SIZE))

    def work(core: Core, frame: Frame) -> Play:
        for source in ("PPI0_DMA", "PPI0_ERROR"):
            core.on_interrupt(source, lambda core: None)
        status = yield from core.ppi_status()
        again = yield from core.ppi_status()
        core.publish(ppi_status=status, ppi_status_again=again)
        got.append(np.concatenate([row.array for row in frame.rows]).view(np.uint32).tolist())
        wide = core.array("wide")
        if by == "mdma":
            registers = {"X_COUNT": BLOCK, "X_MODIFY": STRIDE}
            dma = core.memory_dma("MDMA1_0")
            dma.program(
                source={"START_ADDR": wide.address, **registers},
                destination={"START_ADDR": wide.address + BLOCK * STRIDE, **registers},
            )
            yield from dma.start(DmaConfig(), DmaConfig(WNR=True))
            yield from dma.wait()
        elif by == "core":
            yield core.run(total, core.array("in_sdram"))

    def watched() -> Iterator[Picture]:
        yield from pictures

    outcome = play(every_frame(work), spec=spec, size=QUICK_SIZE, more=(WIDE,), frames=watched())
    assert_accounted(outcome)
    return outcome, got, pictures


def lost_of(outcome: Any, core: str = "A") -> list[int]:
    """Words that a core's PPI lost, by frame."""
    return [each.results.get(f"ppi_words_lost_{core}", 0) for each in outcome.frames]


def test_a_small_fifo_overruns_when_memory_dma_holds_the_bus() -> None:
    """The words lost are published for their frame; the others are in the picture, moved up, in order.

    A word comes in 8 cycles and the FIFO holds one; to open another page of a bank takes tRAS + tRP, which is 9.
    """
    outcome, got, pictures = blocked(quick(0, dma_words=1), by="mdma")
    lost = lost_of(outcome)
    assert lost[0] == 0, "nothing moved while the first picture came"
    assert lost[1] > 0
    for words, picture, missing in zip(got, pictures, lost, strict=True):
        sent = iter(picture.left.view(np.uint32).ravel().tolist())
        kept = len(words) - missing
        assert all(word in sent for word in words[:kept]), (
            "what is kept is what was sent, without the lost words"
        )
    read = [(each.results["ppi_status_A"], each.results["ppi_status_again_A"]) for each in outcome.frames]
    assert read == [(0, 0), (PpiStatusBit.OVR, 0), (0, 0)], (
        "both later pictures come in the first frame; a read clears"
    )
    assert outcome.interrupts == {"A PPI0_DMA": 2, "A PPI0_ERROR": 2}


@pytest.mark.parametrize(
    ("fifo_words", "by"), [(2, "nobody"), (2, "core"), (2, "mdma"), (CHIP.ppi_fifo_words, "mdma")]
)
def test_nothing_is_lost_otherwise(fifo_words: int, by: str) -> None:
    """With the bus free, with a core on it, or with a FIFO of six words or more."""
    outcome, got, pictures = blocked(quick(fifo_words), by=by)
    assert lost_of(outcome) == lost_of(outcome, "B") == [0, 0, 0]
    assert all("ppi_words_lost" not in name for each in outcome.frames for name in each.results)
    assert all(each.results["ppi_status_A"] == 0 for each in outcome.frames)
    # the first picture came before the core asked; the others while it waited for DMA, or in one kernel call
    assert outcome.interrupts == {"A PPI0_DMA": 1 if by == "core" else 2}
    for words, picture in zip(got, pictures, strict=True):
        assert words == picture.left.view(np.uint32).ravel().tolist()
