"""Whole pictures through the stages on the simulated machine, and all that is left in memory against the references."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

import numpy as np
from numpy.typing import NDArray

from bfsim.api import Firmware
from bfsim.chip.boards import CM_BF561
from bfsim.linker import link
from bfsim.machine.board import Board
from bfsim.machine.buffers import FrameSize
from bfsim.machine.symbols import symbols_of
from bfsim.recording import StereoFrame
from bfsim.trace import BoardRecord
from tests.firmware import references
from tests.firmware.blobs import blob_references
from tests.firmware.edges import edge_references
from tests.firmware.lines import line_references, refinement_references
from tests.firmware.pictures import Bytes, random_uyvy
from tests.machine.rig import thesis_ldf
from tinyphoon import tinyphoon
from tinyphoon.stages.blob_detection import LABELS as BLOB_LABELS
from tinyphoon.stages.blob_detection import RECYCLE_AT
from tinyphoon.stages.edge_detection import EdgeThresholds
from tinyphoon.stages.edge_thinning import BANDS
from tinyphoon.stages.hysteresis import LABELS
from tinyphoon.stages.line_segments import SEGMENT_CAPACITY
from tinyphoon.stores.blobs import BLOB_WORDS
from tinyphoon.stores.edges import EDGE_CAPACITY, EDGE_DATA
from tinyphoon.stores.lines import LINE_WORDS
from tinyphoon.strategy.modes import INDOOR_FIELD


def board_for(width: int, height: int, firmware: Firmware = tinyphoon) -> Board:
    """A board with the firmware in it, linked for pictures of that size."""
    size = FrameSize(width, height)
    link_map = link(thesis_ldf(), symbols_of(firmware, size), CM_BF561.chip.regions)
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


def run(frames: Sequence[StereoFrame], firmware: Firmware = tinyphoon) -> tuple[Board, BoardRecord]:
    """Play the frames through the firmware; the board's memories hold what is left of the last one."""
    height, double_width = frames[0].left.shape
    board = board_for(double_width // 2, height, firmware)
    return board, board.run(iter(frames))


def buffer(board: Board, core: str, name: str) -> np.ndarray:
    """Contents of a buffer of a core, row by row."""
    return np.array([row.array for row in board.cores[core].rows(name)])


def check_edges(
    board: Board,
    core: str,
    uyvy: Bytes,
    results: dict[str, int],
    thresholds: EdgeThresholds,
    sighted: NDArray[np.bool_] | None = None,
) -> None:
    """Compare the edge image, the edge store and the counts that core `core` left for the picture `uyvy`.

    Where a rectified picture is not `sighted`, there are no edges.
    """
    smooth = {3: references.gauss3, 5: edge_references.gauss5}[thresholds.gauss_px](references.luma(uyvy))
    gx, gy = references.sobel(smooth)
    direction = references.angle(gx, gy)
    edges = references.suppress(references.magnitude(gx, gy), direction, thresholds.edge_threshold)
    edges = edges if sighted is None else np.where(sighted, edges, 0)
    thinned = edge_references.thinned(edges, EDGE_CAPACITY, BANDS)
    expected = edge_references.hysteresis(thinned, thresholds.strong_threshold, EDGE_CAPACITY, LABELS)
    data, index, counts = edge_references.hysteresis_store(expected.edges, direction)
    np.testing.assert_array_equal(buffer(board, core, "edge_image"), expected.edges)
    assert buffer(board, core, EDGE_DATA[core])[0, : len(data)].tolist() == data
    assert buffer(board, core, "edge_index")[0].tolist() == index
    assert buffer(board, core, "edge_counts")[0].tolist() == counts
    assert results[f"edges_{core}"] == len(data)
    assert results[f"edges_lost_{core}"] == np.count_nonzero(edges) - np.count_nonzero(thinned)
    assert results[f"edge_groups_shared_{core}"] == expected.sharing


def check_lines(board: Board, core: str, uyvy: Bytes, results: dict[str, int]) -> None:
    """Compare the lines that core `core` found with those of the edges that it left, refined by the picture `uyvy`."""
    data, index, counts = (
        buffer(board, core, name)[0].tolist() for name in (EDGE_DATA[core], "edge_index", "edge_counts")
    )
    rows = [
        [(word >> 16, word >> 8 & 255) for word in data[first : first + count]]
        for first, count in zip(index, counts, strict=True)
    ]
    size = buffer(board, core, "edge_image").shape[1], len(rows)
    wanted = line_references.Thresholds(**asdict(INDOOR_FIELD.lines))
    lines, lost = line_references.lines(rows, size, SEGMENT_CAPACITY, wanted, references.angle_of)
    assert results[f"lines_{core}"] == len(lines)
    assert results[f"line_edges_lost_{core}"] == lost
    limits = INDOOR_FIELD.refinement.reach, INDOOR_FIELD.refinement.min_step
    refined, moved = refinement_references.refined(lines, references.luma(uyvy), *limits)
    assert results[f"lines_refined_{core}"] == moved
    stored = buffer(board, core, "lines")[0, : len(lines) * LINE_WORDS]
    assert stored.reshape(-1, LINE_WORDS).tolist() == refined


def check_blobs(board: Board, core: str, opened: references.Picture, results: dict[str, int]) -> None:
    """Compare the blobs that core `core` found with the components of the opened picture."""
    wanted = INDOOR_FIELD.blobs
    left = blob_references.labelled(
        opened, wanted.colour_groups, BLOB_LABELS - 1, RECYCLE_AT, wanted.min_pixels
    )
    found = [
        each.words
        for each in blob_references.segments(left.picture, wanted.colour_groups)
        if wanted.min_pixels <= len(each.pixels) <= wanted.max_pixels
    ]
    kept = found[: wanted.max_blobs]
    stored = buffer(board, core, "blob_data")[0, : len(kept) * BLOB_WORDS]
    assert stored.reshape(-1, BLOB_WORDS).tolist() == kept
    assert results[f"blobs_{core}"] == len(kept)
    assert results[f"blobs_lost_{core}"] == len(found) - len(kept)
    assert results[f"labels_lost_{core}"] == left.lost


def check_core(
    board: Board,
    core: str,
    uyvy: Bytes,
    results: dict[str, int],
    sighted: NDArray[np.bool_] | None = None,
) -> None:
    """Compare all that core `core` left in memory and published for the picture `uyvy`."""
    check_edges(board, core, uyvy, results, INDOOR_FIELD.edges, sighted)
    limits = INDOOR_FIELD.edges.colour_limits
    colours = references.colours(uyvy, *limits, INDOOR_FIELD.blobs.colour_groups)
    opened = references.dilate(references.erode(colours))
    np.testing.assert_array_equal(buffer(board, core, "colour_image"), colours)
    np.testing.assert_array_equal(buffer(board, core, "opened_image"), opened)
    check_blobs(board, core, opened.astype(np.uint32), results)
    check_lines(board, core, uyvy, results)


def check_last_frame(frames: Sequence[StereoFrame], firmware: Firmware = tinyphoon) -> BoardRecord:
    """Run the frames and compare what both cores made of the last one."""
    board, outcome = run(frames, firmware)
    assert [each.index for each in outcome.frames] == [each.index for each in frames]
    results = dict(outcome.frames[-1].results)
    check_core(board, "A", frames[-1].left, results)
    check_core(board, "B", frames[-1].right, results)
    return outcome
