"""The steps that the thesis describes leave what the built-in ones leave; its scan for lines is another one."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from bfsim.api import Core, Firmware
from bfsim.machine.board import Board
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.run import BUILT_IN_RECORDING
from tests.firmware.pictures import EXTREMES, grey_uyvy
from tests.firmware.whole_pictures import buffer, random_frames, run, stereo
from tinyphoon import thesis, tinyphoon
from tinyphoon.areas import WHOLE_PICTURE
from tinyphoon.features import PLAIN, Steps
from tinyphoon.stages.line_ends import continued_line
from tinyphoon.stages.line_segments import (
    DIRECTION,
    EDGES,
    END_X,
    END_Y,
    NONE,
    SEGMENT_WORDS,
    START_X,
    START_Y,
    TURN,
)
from tinyphoon.stages.rosenfeld_blobs import label_row, rename_row
from tinyphoon.stores.blobs import BLOB_WORDS
from tinyphoon.stores.edges import EDGE_DATA
from tinyphoon.strategy.modes import INDOOR_FIELD
from tinyphoon.variants import THESIS

SAME = ("edges", "edges_lost", "edge_groups_shared", "blobs", "blobs_lost", "labels_lost")


def left_by(board: Board, core: str, counts: dict[str, int]) -> list[list[int]]:
    """Edges, colours and blobs of a core."""
    edges = buffer(board, core, EDGE_DATA[core])[0, : counts[f"edges_{core}"]]
    blobs = buffer(board, core, "blob_data")[0, : counts[f"blobs_{core}"] * BLOB_WORDS]
    pictures = (buffer(board, core, name).ravel() for name in ("edge_image", "opened_image"))
    rows = (buffer(board, core, name)[0] for name in ("edge_index", "edge_counts"))
    return [each.tolist() for each in (edges, blobs, *pictures, *rows)]


def up_to_blobs(firmware: Firmware, steps: Steps) -> Firmware:
    """The firmware without what comes behind the blobs: lines differ, and blobs are merged by them."""

    def main(core: Core) -> Generator[Any, Any, None]:
        while (frame := (yield from core.next_frame())) is not None:
            with core.stage("Edge detection"):
                yield from steps.edge_detection(core, frame, INDOOR_FIELD.edges, WHOLE_PICTURE)
                yield from steps.open_closing(core, frame, INDOOR_FIELD.noise)
                yield from steps.blob_detection(core, frame, INDOOR_FIELD.blobs)

    return replace(firmware, mains={"A": main, "B": main})


def check_same(frames: Sequence[StereoFrame]) -> None:
    """Compare what both firmwares leave of the last frame, on both cores."""
    plain, of_plain = run(frames, up_to_blobs(tinyphoon, PLAIN))
    other, of_other = run(frames, up_to_blobs(thesis, THESIS))
    counts, others = (dict(each.frames[-1].results) for each in (of_plain, of_other))
    for core in "AB":
        assert [counts[f"{name}_{core}"] for name in SAME] == [others[f"{name}_{core}"] for name in SAME]
        assert left_by(plain, core, counts) == left_by(other, core, counts)


@pytest.mark.parametrize(("width", "height"), [(4, 3), (10, 5), (34, 50), (160, 121)])
def test_pictures_of_any_size(width: int, height: int) -> None:
    """Coloured squares: many groups of edges and blobs of all colours, after another frame."""
    check_same(random_frames(width, height, count=2))


def test_the_built_in_recording() -> None:
    """Its second frame."""
    with RecordingReader(BUILT_IN_RECORDING) as reader:
        check_same(list(reader.frames(2)))


@pytest.mark.parametrize("name", ["checkerboard of five pixels", "slopes", "coloured columns", "noise"])
def test_extremes(name: str) -> None:
    """As far as the stores have room for what they show."""
    picture = EXTREMES[name](40, 30)
    check_same(stereo((picture, picture[::-1].copy())))


def test_edges_beyond_the_store_are_those_at_the_bottom() -> None:
    """The store fills from the top, as the thesis has it; the built-in firmware thins edges out everywhere."""
    noise = np.random.default_rng(5).integers(0, 256, (240, 640), np.uint8)
    board, outcome = run(stereo((noise, np.zeros_like(noise))), thesis)
    counts = buffer(board, "A", "edge_counts")[0]
    assert dict(outcome.frames[0].results)["edges_lost_A"] > 1000
    assert "those at the bottom" in thesis.losses["edges_lost"]
    assert counts[20:40].min() > 0
    assert counts[-20:].max() == 0


def labels_of(picture: Sequence[str]) -> list[list[int]]:
    """Labels of the pixels that are not blank, renamed by the table."""
    words = np.array([[int(pixel != " ") for pixel in row] for row in picture], np.uint32)
    labels, table = np.zeros(words.shape, np.uint16), np.zeros(64, np.uint16)
    used = 0
    for y in range(1, len(words) - 1):
        used = label_row(words[y], labels[y - 1], labels[y], table, 1, 0, used)
    for row in labels:
        rename_row(row, table)
    return labels.tolist()


def test_labels_that_meet_become_the_smaller_one() -> None:
    """T Figure 2.7.b: two arms meet below; what touches by a corner only belongs to it, too."""
    found = labels_of(["       ", " #   # ", " #   # ", "  ###  ", "     # ", "       "])
    assert found == [
        [0, 0, 0, 0, 0, 0, 0],
        [0, 1, 0, 0, 0, 1, 0],
        [0, 1, 0, 0, 0, 1, 0],
        [0, 0, 1, 1, 1, 0, 0],
        [0, 0, 0, 0, 0, 1, 0],
        [0, 0, 0, 0, 0, 0, 0],
    ]


def segment(direction: int, start: tuple[int, int], end: tuple[int, int]) -> np.ndarray:
    """A table with one line of four edges behind an empty place."""
    table = np.zeros((2, SEGMENT_WORDS), np.int32)
    table[1, [EDGES, DIRECTION, TURN]] = 4, direction, 0
    table[1, [START_X, START_Y, END_X, END_Y]] = *start, *end
    return table.ravel()


@pytest.mark.parametrize(
    ("direction", "x", "y", "place"),
    [
        (0, 21, 31, 1),  # a steep line: below its end
        (8, 21, 31, 1),  # within the angle range
        (9, 21, 31, NONE),
        (0, 22, 31, NONE),  # not next to the end
        (0, 10, 10, NONE),  # its start is none of the ends that are compared
    ],
)
def test_an_edge_continues_the_line_whose_end_it_lies_next_to(
    direction: int, x: int, y: int, place: int
) -> None:
    """T §5.2.2, step 1."""
    table = segment(0, (10, 10), (20, 30))
    assert continued_line(table, x, y, direction, 8, 4) == place


def test_a_line_that_becomes_flat_from_the_right_to_the_left_is_continued_at_its_start() -> None:
    """The special case of T §5.2.2: the scan goes from the left to the right."""
    table = segment(64, (10, 30), (40, 28))
    assert continued_line(table, 9, 31, 64, 8, 4) == 1
    assert continued_line(table, 41, 28, 64, 8, 4) == 1


def test_the_borders_of_a_square_are_four_lines() -> None:
    """By both scans."""
    luma = np.full((80, 80), 40, np.uint8)
    luma[20:60, 20:60] = 200
    frames = stereo((grey_uyvy(luma), grey_uyvy(luma)))
    for firmware in (tinyphoon, thesis):
        _, outcome = run(frames, firmware)
        assert dict(outcome.frames[0].results)["lines_A"] == 4
