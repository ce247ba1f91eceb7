"""Read the rectification tables of two cameras from files of numpy."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from bfsim.errors import RecordingError
from bfsim.files.content import read_bounded
from bfsim.recording.frames import RectificationTables
from bfsim.recording.layout import table_from_npy

LARGEST_TABLE_MB = 256
"""Of a table: at most 16 bytes a pixel."""


def load_rectification(left: str | os.PathLike[str], right: str | os.PathLike[str]) -> RectificationTables:
    """Return rectification tables from two .npy files of integers: source rows and source columns, -1 for nothing.

    Raises RecordingError for a file that cannot be read or holds anything else.
    """
    tables = []
    for path in (left, right):
        try:
            table = table_from_npy(read_bounded(Path(path), most_mb=LARGEST_TABLE_MB))
        except OSError as error:
            raise RecordingError(
                f"{path}: rectification table must be a readable file: {error.strerror}"
            ) from None
        except RecordingError as error:
            raise RecordingError(f"{path}: {error}") from None
        if table.dtype.kind not in "iu" or table.ndim != 3:
            raise RecordingError(
                f"{path}: rectification table must hold integers of shape (2, height, width), "
                f"not {table.dtype} of shape {table.shape}"
            )
        bounds = np.iinfo(np.int32)
        tables.append(np.clip(table, bounds.min, bounds.max).astype(np.int32))
    return RectificationTables(*tables)
