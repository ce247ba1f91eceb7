"""`benchmarks/real_pictures.py` on a recording: it is seen as rectified, and judged beside a dense matcher."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from benchmarks.real import depth
from benchmarks.real.sets import read_recording
from benchmarks.real_pictures import see, sets_in
from bfsim.recording import RecordingReader, RectificationTables
from bfsim.recording.writer import RecordingWriter
from bfsim.shipped import RECORDING

LOWER = 3
"""Rows by which the right camera looks too low; its table undoes it."""


def test_a_recording_is_seen_as_rectified(tmp_path: Path) -> None:
    """The first frame of the built-in recording, its right picture some rows too high: as many edges as without, and as right."""
    with RecordingReader(RECORDING) as reader:
        (frame,) = reader.frames(limit=1)
        geometry, size = reader.geometry, {"width": reader.width, "height": reader.height}
    rows, columns = np.indices((size["height"], size["width"]), np.int32)
    plain, lower = np.stack([rows, columns]), np.stack([rows - LOWER, columns])
    lower[:, :LOWER] = -1
    tables = RectificationTables(plain, lower)
    path = tmp_path / "low.mcap"
    with RecordingWriter(path, geometry=geometry, rectification=tables, **size) as writer:
        writer.add(frame.left, np.roll(frame.right, -LOWER, axis=0), 0, 0)

    assert sets_in(path) == [path]
    seen = see(path, (320, 240))
    assert (seen.pictures.name, seen.pictures.is_stereo) == ("low", True)
    left, right = seen.pictures.lumas(seen.pictures.frames[0])
    assert (left == frame.left[:, 1::2]).all()
    assert (right[LOWER:] == frame.right[LOWER:, 1::2]).all()
    assert not right[:LOWER].any()
    edges, lines = (
        dict(zip(depth.COLUMNS, row, strict=True))
        for row in depth.rows_of(seen.pictures, seen.played, seen.alone)
    )
    assert int(edges["of them judged"].split()[0]) > 200
    for kind in (edges, lines):
        assert float(kind["within 1 px %"]) > 90
        assert float(kind["over 5 px off %"]) < 3
    assert 66 < float(edges["right kept %"]) <= 100


SQUARE_PX, SHIFT_PX, WALL = 20, 24, 100


def test_a_board_is_its_own_truth(tmp_path: Path) -> None:
    """A board of squares, lit from one side, before a wall: 3-D edges and the dense matcher are judged by its plane."""
    rows, columns = np.indices((240, 320), np.int32)
    squares = ((rows // SQUARE_PX + columns // SQUARE_PX) % 2).astype(bool)
    board = np.full((240, 320), WALL, np.uint8)
    board[40:180, 80:280] = np.where(squares, columns // 2 + 100, 20)[40:180, 80:280]
    lumas = board, np.roll(board, -SHIFT_PX, axis=1)
    frames = [np.stack([np.full_like(each, 128), each], axis=-1).reshape(240, 640) for each in lumas]
    plain = np.stack([rows, columns])
    path = tmp_path / "board.mcap"
    tables = RectificationTables(plain, plain)
    with RecordingWriter(path, width=320, height=240, rectification=tables) as writer:
        writer.add(*frames, 0, 0)

    seen = see(path, (320, 240))
    (truth,) = depth.true_disparities(seen.pictures)
    assert np.allclose(truth[60:160, 100:260], SHIFT_PX, atol=0.3)
    assert np.isnan(truth[:50]).all()
    judged = {(row[0], row[1]): row[2:6] for row in depth.rows_of(seen.pictures, seen.played, seen.alone)}
    assert set(judged) == {(by, kind) for by in ("SGBM", "truth") for kind in ("edges", "lines")} | {
        ("truth", "SGBM")
    }
    for kind in ("edges", "SGBM"):
        number, within, _, far = judged["truth", kind]
        assert int(number.split()[0]) > 200
        assert float(within) > 95
        assert float(far) < 3


def test_a_recording_of_one_camera_is_no_pair(tmp_path: Path) -> None:
    """Both sides have the same picture."""
    picture = np.full((4, 16), 128, np.uint8)
    with RecordingWriter(tmp_path / "one.mcap", width=8, height=4) as writer:
        writer.add(picture, picture, 0, 0)
    assert not read_recording(tmp_path / "one.mcap").is_stereo
