"""Chessboards for the tests of calibration."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from bfsim.recording.calibrating import boards
from bfsim.recording.planes import Plane
from bfsim.recording.scenes.chessboard import write_chessboards
from tests.recording.chessboards import GEOMETRY, MISFIT


@pytest.fixture(scope="session")
def searched_once() -> Iterator[None]:
    """Let each picture be searched for corners once: OpenCV takes its time, and the same pictures are in many sets."""
    search, known = boards._corners_in, dict[tuple[bytes, tuple[int, int]], boards.Corners]()

    def found_before(cv2: Any, grey: Plane, corners: tuple[int, int]) -> boards.Corners:
        key = grey.tobytes(), corners
        if key not in known:
            known[key] = search(cv2, grey, corners)
        return known[key].copy()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(boards, "_corners_in", found_before)
        yield


@pytest.fixture(scope="session")
def chessboards(tmp_path_factory: pytest.TempPathFactory, searched_once: None) -> Path:
    """Pairs of pictures of a chessboard through the lenses."""
    folder = tmp_path_factory.mktemp("chessboards")
    assert write_chessboards(folder, GEOMETRY, MISFIT, seed=1) == 27
    return folder
