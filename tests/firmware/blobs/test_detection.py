"""The blob detection on the simulated machine: its blobs against flood fill, and what its cycles depend on."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from bfsim.api import BudgetRow, Buffer, Core, Firmware, FrameSize, u8, u32
from bfsim.chip.boards import CM_BF561
from bfsim.linker import link
from bfsim.machine.board import Board
from bfsim.machine.symbols import symbols_of
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.shipped import RECORDING
from tests.firmware import references
from tests.firmware.blobs.blob_references import labelled, segments
from tests.firmware.blobs.colour_pictures import (
    BLUE,
    GROUPS,
    HARD_PICTURES,
    RED,
    Words,
    checkerboard,
    dots,
    scattered,
)
from tests.machine.rig import thesis_ldf
from tinyphoon.stages.blob_detection import (
    LABELS,
    RECYCLE_AT,
    BlobThresholds,
    blob_buffers,
    blob_detection,
)
from tinyphoon.stores.blobs import BLOB_WORDS
from tinyphoon.strategy.modes import INDOOR_FIELD

ROW = "Blob detection"
EVERY_SEGMENT = BlobThresholds(colour_groups=GROUPS, min_pixels=1, max_pixels=2**32 - 1, max_blobs=LABELS - 1)


@dataclass(frozen=True, slots=True)
class Seen:
    """What a core made of an opened image: the records of its blobs, what it published, and its cycles."""

    records: list[list[int]]
    results: dict[str, int]
    issue_cclk: int


def on_machine(pictures: Sequence[Words], thresholds: BlobThresholds, frames: int = 1) -> list[Seen]:
    """Let the stage alone run on opened images that are there already, one a core."""
    height, width = pictures[0].shape

    def main(core: Core) -> Generator[Any, Any, None]:
        while (frame := (yield from core.next_frame())) is not None:
            with core.stage(ROW):
                yield from blob_detection(core, frame, thresholds)

    def buffers(size: FrameSize) -> dict[str, Sequence[Buffer]]:
        return {
            core: (
                Buffer("camera", u8, 2 * width, "sdram_bank0", rows=2 * height),
                Buffer("opened_image", u32, width, "sdram_bank2", rows=height, values=picture),
                Buffer("opened_ring", u32, width, "L1_data_a", rows=2),
                *blob_buffers(size),
            )
            for core, picture in zip("AB", pictures, strict=False)
        }

    rows = (BudgetRow(stage=ROW),)
    firmware = Firmware(mains=dict.fromkeys("AB", main), buffers=buffers, camera="camera", rows=rows)
    size = FrameSize(width, height)
    link_map = link(thesis_ldf(), symbols_of(firmware, size), CM_BF561.chip.regions)
    board, black = Board(CM_BF561, firmware, size, link_map), np.zeros((height, 2 * width), np.uint8)
    shots = [StereoFrame(index, black, black, index, index, truth=None) for index in range(frames)]
    last = board.run(iter(shots)).frames[-1]
    return [_seen(board, last.results, core.core, core.stages) for core in last.cores]


def _seen(board: Board, results: dict[str, int], name: str, stages: Sequence[Any]) -> Seen:
    own = {key[:-2]: value for key, value in results.items() if key.endswith(f"_{name}")}
    data = board.cores[name].array("blob_data").array.reshape(-1, BLOB_WORDS)
    (cycles,) = [each.issue_cclk for each in stages if each.stage == ROW]
    return Seen(data[: own["blobs"]].tolist(), own, cycles)


def check(pictures: Sequence[Words], thresholds: BlobThresholds) -> list[Seen]:
    """Compare what both cores found in two pictures with the flood fill."""
    seen = on_machine(pictures, thresholds)
    for found, picture in zip(seen, pictures, strict=True):
        left = labelled(picture, thresholds.colour_groups, LABELS - 1, RECYCLE_AT, thresholds.min_pixels)
        sizes = range(thresholds.min_pixels, thresholds.max_pixels + 1)
        expected = [
            each.words
            for each in segments(left.picture, thresholds.colour_groups)
            if len(each.pixels) in sizes
        ]
        kept = expected[: thresholds.max_blobs]
        assert found.records == kept
        lost = len(expected) - len(kept)
        assert found.results == {"blobs": len(kept), "blobs_lost": lost, "labels_lost": left.lost}
    return seen


@pytest.fixture(scope="module")
def shipped() -> list[tuple[Words, Words]]:
    """The opened images of the built-in recording, left and right."""
    with RecordingReader(RECORDING) as reader:
        return [(opened(frame.left), opened(frame.right)) for frame in reader.frames()]


def opened(uyvy: np.ndarray) -> Words:
    """Return the opened colour image of a picture."""
    rule = INDOOR_FIELD.edges
    colours = references.colours(uyvy, *rule.colour_limits, INDOOR_FIELD.blobs.colour_groups)
    return references.dilate(references.erode(colours)).astype(np.uint32)


def test_ball_goal_and_mark_of_the_built_in_recording(shipped: list[tuple[Words, Words]]) -> None:
    """Both cores find the blobs of the flood fill, and among them one of each colour that is on the field."""
    for found in check(shipped[0], INDOOR_FIELD.blobs):
        assert {record[0] for record in found.records} == set(INDOOR_FIELD.blobs.colour_groups)


@pytest.mark.parametrize("name", [name for name, each in HARD_PICTURES.items() if each.shape[1] % 2 == 0])
def test_hard_pictures(name: str) -> None:
    """On one core as drawn, on the other upside down."""
    check((HARD_PICTURES[name], HARD_PICTURES[name][::-1].copy()), EVERY_SEGMENT)


@pytest.mark.parametrize(("width", "height"), [(2, 1), (2, 9), (34, 1), (62, 35), (640, 12)])
def test_pictures_of_any_size(width: int, height: int) -> None:
    """Narrow, low and wide pictures; labels and room for blobs run out in the larger ones."""
    check((scattered(height, width, seed=3), scattered(height, width, seed=4, square=3)), EVERY_SEGMENT)


def test_what_has_no_room_is_counted() -> None:
    """More dots than labels, and more blobs than are kept: the topmost stay, each core says what it lost."""
    few = BlobThresholds(colour_groups=GROUPS, min_pixels=1, max_pixels=9, max_blobs=7)
    dotted, black = dots(40, 80), np.zeros((40, 80), np.uint32)
    on_a, on_b = check((dotted, black), few)
    most = LABELS - 1
    assert on_a.results == {"blobs": 7, "blobs_lost": most - 7, "labels_lost": 20 * 40 - most}
    assert on_b.results == {"blobs": 0, "blobs_lost": 0, "labels_lost": 0}


def test_a_frame_leaves_nothing_behind_for_the_next() -> None:
    """The third frame of one picture gives what the first one gave, though its last row looks like its first."""
    pictures = np.full((8, 12), RED, np.uint32), checkerboard(8, 12, RED, BLUE)
    once, thrice = on_machine(pictures, EVERY_SEGMENT), on_machine(pictures, EVERY_SEGMENT, frames=3)
    assert [each.records for each in once] == [each.records for each in thrice]
    assert [each.results for each in once] == [each.results for each in thrice]


def test_cycles_vary_little_over_the_shipped_frames(shipped: list[tuple[Words, Words]]) -> None:
    """T §6.6: the time hardly depends on the scene. Here it varies by 2.1 %, as the area of the colours does."""
    cycles = [seen.issue_cclk for pair in shipped for seen in on_machine(pair, INDOOR_FIELD.blobs)]
    assert max(cycles) < 1.05 * min(cycles)


def cycles(*pair: Words) -> list[int]:
    """Issue cycles of the stage on a picture a core."""
    return [seen.issue_cclk for seen in on_machine(pair, EVERY_SEGMENT)]


def test_cycles_of_even_pictures() -> None:
    """One colour costs about as much as none: GCC's code takes 3,433 cycles for a red row and 2,304 for a black one."""
    black, full = np.zeros((240, 320), np.uint32), np.full((240, 320), RED, np.uint32)
    nothing, all_red = cycles(black, full)
    assert 0.7 * nothing < all_red < 1.5 * nothing


def test_cycles_grow_with_runs_and_labels() -> None:
    """The most runs that an opened image can have cost a lot more than a black picture, and runs of a pixel still more.

    GCC's code takes 47,571 cycles a row of squares, 21 times a black one; the model says 15 times.
    """
    squares = checkerboard(240, 320, RED, BLUE, square=3)
    pixels = checkerboard(240, 320, RED, BLUE)
    nothing, _ = cycles(np.zeros((240, 320), np.uint32), np.zeros((240, 320), np.uint32))
    opened_worst, worst = cycles(squares, pixels)
    assert 5 * nothing < opened_worst < worst / 2
