"""The stages on the simulated machine: whole pictures in SDRAM and the edge store, bit for bit against numpy."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bfsim.api import Core, Firmware
from bfsim.chip.boards import CM_BF561
from bfsim.errors import LinkError
from bfsim.linker import link, parse_ldf
from bfsim.machine.board import Board, Outcome, symbols_of
from bfsim.machine.program import FrameSize
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.run import BUILT_IN_RECORDING, THESIS_LDF
from firmware import tinyphoon
from firmware.edge_store import EDGE_CAPACITY
from firmware.modes import INDOOR_FIELD
from firmware.stages.edge_detection import EdgeThresholds, edge_detection
from firmware.stages.hysteresis import LABELS
from tests.firmware import edge_references, references, refinement_references
from tests.firmware.line_rig import find_lines
from tests.firmware.pictures import Bytes, random_uyvy


def board_for(width: int, height: int, firmware: Firmware = tinyphoon) -> Board:
    """A board with the firmware in it, linked for pictures of that size."""
    size = FrameSize(width, height)
    link_map = link(parse_ldf(THESIS_LDF), symbols_of(firmware, size), CM_BF561.chip.regions)
    return Board(CM_BF561, firmware, size, link_map)


def stereo(*pairs: tuple[Bytes, Bytes]) -> list[StereoFrame]:
    """Stereo frames of these pictures."""
    return [
        StereoFrame(index, left, right, left_ns=index, right_ns=index, truth=None)
        for index, (left, right) in enumerate(pairs)
    ]


def random_frames(width: int, height: int, count: int) -> list[StereoFrame]:
    """Stereo frames that have nothing to do with each other."""
    pictures = [random_uyvy(width, height, seed) for seed in range(2 * count)]
    return stereo(*zip(pictures[::2], pictures[1::2], strict=True))


def run(frames: Sequence[StereoFrame], firmware: Firmware = tinyphoon) -> tuple[Board, Outcome]:
    """Play the frames through the firmware; the board's memories hold what is left of the last one."""
    height, double_width = frames[0].left.shape
    board = board_for(double_width // 2, height, firmware)
    return board, board.run(iter(frames))


def buffer(board: Board, core: str, name: str) -> np.ndarray:
    """Contents of a buffer of a core, row by row."""
    return np.array([row.array for row in board.cores[core].rows(name)])


def check_edges(
    board: Board, core: str, uyvy: Bytes, results: dict[str, int], thresholds: EdgeThresholds
) -> None:
    """Compare the edge image, the edge store and the counts that core `core` left for the picture `uyvy`."""
    smooth = {3: references.gauss3, 5: edge_references.gauss5}[thresholds.gauss_px](references.luma(uyvy))
    gx, gy = references.sobel(smooth)
    direction = references.angle(gx, gy)
    edges = references.suppress(references.magnitude(gx, gy), direction, thresholds.edge_threshold)
    expected = edge_references.hysteresis(edges, thresholds.strong_threshold, EDGE_CAPACITY, LABELS)
    data, index, counts = edge_references.hysteresis_store(expected.edges, direction)
    np.testing.assert_array_equal(buffer(board, core, "edge_image"), expected.edges)
    assert buffer(board, core, "edge_data")[0, : len(data)].tolist() == data
    assert buffer(board, core, "edge_index")[0].tolist() == index
    assert buffer(board, core, "edge_counts")[0].tolist() == counts
    assert results[f"edges_{core}"] == len(data)
    assert results[f"edges_lost_{core}"] == expected.lost
    assert results[f"edge_groups_shared_{core}"] == expected.sharing


def check_lines(board: Board, core: str, uyvy: Bytes, results: dict[str, int]) -> None:
    """Compare the lines that core `core` found with those of the edges that it left, refined by the picture `uyvy`."""
    data, index, counts = (
        buffer(board, core, f"edge_{name}")[0].tolist() for name in ("data", "index", "counts")
    )
    rows = [
        [(word >> 16, word >> 8 & 255) for word in data[first : first + count]]
        for first, count in zip(index, counts, strict=True)
    ]
    lines = find_lines(rows, buffer(board, core, "edge_image").shape[1])
    assert results[f"lines_{core}"] == len(lines.lines)
    assert results[f"line_edges_lost_{core}"] == lines.lost
    limits = INDOOR_FIELD.refinement.reach, INDOOR_FIELD.refinement.min_step
    refined, moved = refinement_references.refined(lines.lines.tolist(), references.luma(uyvy), *limits)
    assert results[f"lines_refined_{core}"] == moved
    found = buffer(board, core, "lines")[0, : lines.lines.size].reshape(lines.lines.shape)
    assert found.tolist() == refined


def check_core(board: Board, core: str, uyvy: Bytes, results: dict[str, int]) -> None:
    """Compare all that core `core` left in memory and published for the picture `uyvy`."""
    check_edges(board, core, uyvy, results, INDOOR_FIELD.edges)
    colours = references.colours(uyvy, INDOOR_FIELD.edges.eps_black, INDOOR_FIELD.edges.eps_white)
    opened = references.dilate(references.erode(colours))
    np.testing.assert_array_equal(buffer(board, core, "colour_image"), colours)
    np.testing.assert_array_equal(buffer(board, core, "opened_image"), opened)
    check_lines(board, core, uyvy, results)


def check_last_frame(frames: Sequence[StereoFrame]) -> Outcome:
    """Run the frames and compare what both cores made of the last one."""
    board, outcome = run(frames)
    assert [each.index for each in outcome.frames] == [each.index for each in frames]
    results = dict(outcome.frames[-1].results)
    check_core(board, "A", frames[-1].left, results)
    check_core(board, "B", frames[-1].right, results)
    return outcome


@pytest.mark.parametrize("count", [1, 2])
def test_built_in_recording(count: int) -> None:
    """The first and the second frame of the soccer scene come out as in numpy, on both cores."""
    with RecordingReader(BUILT_IN_RECORDING) as reader:
        check_last_frame(list(reader.frames(count)))


@pytest.mark.parametrize(
    ("width", "height"), [(4, 3), (4, 1), (6, 2), (6, 4), (10, 5), (62, 7), (34, 50), (160, 121), (640, 16)]
)
def test_pictures_of_any_size(width: int, height: int) -> None:
    """Narrow, low and wide pictures, three frames after each other in all three frame buffers."""
    check_last_frame(random_frames(width, height, count=3))


@pytest.mark.parametrize("value", [0, 128, 255])
def test_flat_pictures_have_no_edges(value: int) -> None:
    """A picture of one value has no edge anywhere, not even at its border."""
    flat = np.full((12, 40), value, np.uint8)
    outcome = check_last_frame(stereo((flat, flat)))
    assert set(outcome.frames[0].results.values()) == {0}


def test_full_edge_store_keeps_the_top_of_the_picture_and_says_what_it_lost() -> None:
    """More edges than the store holds are counted, each core for itself, and the first ones are kept."""
    noise = np.random.default_rng(5).integers(0, 256, (240, 640), np.uint8)
    outcome = check_last_frame(stereo((noise, np.zeros_like(noise))))
    results = outcome.frames[0].results
    assert EDGE_CAPACITY // 2 < results["edges_A"] <= EDGE_CAPACITY
    assert results["edges_lost_A"] > 1000
    assert (results["edges_B"], results["edges_lost_B"]) == (0, 0)


def specks(width: int, height: int) -> Bytes:
    """As many bright points as find room without touching each other's edges."""
    uyvy = np.full((height, 2 * width), 128, np.uint8)
    uyvy[:, 1::2] = 0
    uyvy[4::8, 9::16] = 200
    return uyvy


def test_more_groups_than_labels_are_counted() -> None:
    """Bright specks, each a group of few edges, ask for more labels than there are."""
    picture = specks(640, 480)
    outcome = check_last_frame(stereo((picture, np.zeros_like(picture))))
    assert outcome.frames[0].results["edge_groups_shared_A"] > 0


@pytest.mark.parametrize(("width", "height"), [(6, 4), (34, 50), (160, 121)])
def test_larger_gauss(width: int, height: int) -> None:
    """The edges behind the 5x5 Gauss, which needs two lines more of the picture at a time."""
    thresholds = replace(INDOOR_FIELD.edges, gauss_px=5)

    def main(core: Core) -> Generator[Any, Any, None]:
        while (frame := (yield from core.next_frame())) is not None:
            with core.stage("Edge detection"):
                yield from edge_detection(core, frame, thresholds)

    frames = random_frames(width, height, count=2)
    board, outcome = run(frames, replace(tinyphoon, mains={"A": main, "B": main}))
    check_edges(board, "A", frames[-1].left, dict(outcome.frames[-1].results), thresholds)
    check_edges(board, "B", frames[-1].right, dict(outcome.frames[-1].results), thresholds)


def test_frames_leave_nothing_behind() -> None:
    """A frame gives the same results after another one as it gives alone."""
    first, second = random_frames(64, 20, count=2)
    _, both = run([first, second])
    _, alone = run([replace(second, index=0)])
    assert both.frames[1].results == alone.frames[0].results


@pytest.mark.parametrize(("width", "height"), [(160, 120), (320, 240), (640, 480)])
def test_everything_fits_in_the_memories_of_the_thesis(width: int, height: int) -> None:
    """Every buffer of all three picture sizes of the robot finds its place, and what asks for L1 is there."""
    placements = board_for(width, height).link_map.placements
    for_l1 = [each for each in placements if each.symbol.section.startswith("L1_data")]
    assert for_l1
    assert all("L1_DATA" in each.segment for each in for_l1)


def test_lines_too_wide_for_l1_are_a_link_error() -> None:
    """800 pixels do not fit: the linker refuses, it does not spill rings into slow memory."""
    with pytest.raises(LinkError, match="_ring"):
        board_for(800, 600)
