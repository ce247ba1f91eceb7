"""The layout of a recording in its MCAP file: the names, and the two small encodings of our own.

Pictures are `foxglove.RawImage` messages (encoding `uyvy`), so that Foxglove and other viewers show them.
A message's log time is the moment the picture was taken, in nanoseconds since the recording's own epoch.
"""

from __future__ import annotations

import io
import json
import math
import zlib
from collections.abc import Mapping
from tokenize import TokenError
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import RecordingError, cut

LEFT_TOPIC = "/camera/left/image_raw"
RIGHT_TOPIC = "/camera/right/image_raw"
TRUTH_TOPIC = "/truth"
DISPARITY_TOPIC = "/truth/disparity"
TOPICS = (LEFT_TOPIC, RIGHT_TOPIC, TRUTH_TOPIC, DISPARITY_TOPIC)

IMAGE_SCHEMA = "foxglove.RawImage"
IMAGE_ENCODINGS = ("uyvy", "yuv422")
"""The RawImage schema's two names for the byte order U0 Y0 V0 Y1; the first is the one written."""

TRUTH_SCHEMA = "bfsim.GroundTruth"
TRUTH_JSON_SCHEMA = json.dumps({"title": TRUTH_SCHEMA, "type": "object"}).encode()
"""One object a frame; the message's sequence number is the frame's index."""

DISPARITY_ENCODING = "32FC1"
"""Little-endian float32 disparities in px of the left camera, as a RawImage with the sequence number of its frame."""

GEOMETRY_RECORD = "stereo_geometry"
CALIBRATION_RECORD = "calibration"
"""One entry, `json`: a CalibrationReport."""
RESIDUAL_PLOT_NAME = "calibration_residuals.png"
"""Attachment: the plot of `residual_plot`."""
DESCRIPTION_RECORD = "recording"
RECTIFICATION_NAMES = {"left": "rectification_left.npy", "right": "rectification_right.npy"}
"""Attachments: .npy arrays (NumPy's format 1.0), int32, (2, height, width), as in `RectificationTables`."""

CHUNK_BYTES = 1 << 20
"""Chunks are decompressed as a whole: small ones save memory, large ones keep the index short."""

LARGEST_PICTURE_BYTES = 64 << 20
"""The whole SDRAM of the largest board, and half a chunk."""

LAST_NS = (1 << 63) - 1
"""MCAP could hold twice as much, but viewers and numpy use signed nanoseconds."""

CRC_KEY = "crc32"
LIBRARY_PREFIX = "bfsim/"


def seal(record: Mapping[str, str]) -> dict[str, str]:
    """Return a metadata record with a checksum of its entries: MCAP protects only chunks, attachments and index."""
    return {**record, CRC_KEY: f"{_metadata_crc(record):08x}"}


def unseal(record: Mapping[str, str], library: str) -> dict[str, str]:
    """Return the entries of a metadata record without the checksum; raise ValueError if it does not match.

    Only records written by bfsim itself, according to the file's `library`, must have one.
    """
    entries = {key: value for key, value in record.items() if key != CRC_KEY}
    unsealed = CRC_KEY not in record and not library.startswith(LIBRARY_PREFIX)
    if not unsealed and record.get(CRC_KEY) != f"{_metadata_crc(entries):08x}":
        raise ValueError("its checksum does not match its entries")
    return entries


def _metadata_crc(record: Mapping[str, str]) -> int:
    return zlib.crc32(json.dumps(sorted(record.items())).encode())


def table_to_npy(table: NDArray[np.int32]) -> bytes:
    """Return a rectification table as the bytes of a .npy file."""
    stream = io.BytesIO()
    np.save(stream, table, allow_pickle=False)
    return stream.getvalue()


def table_from_npy(data: bytes) -> NDArray[np.int32]:
    """Return a rectification table from the bytes of a .npy file; its type and shape are not checked here."""
    try:
        return _array_in(data)
    # errors of NumPy when it cannot read a header, which is Python source
    except (
        ValueError,
        TypeError,
        LookupError,
        SyntaxError,
        EOFError,
        ArithmeticError,
        RecursionError,
        TokenError,
    ) as error:
        said = cut(str(error))
        raise RecordingError(f"rectification table must be a .npy array, which it is not: {said}") from None


def _array_in(data: bytes) -> NDArray[Any]:
    stream = io.BytesIO(data)
    read_header = _NPY_HEADERS[np.lib.format.read_magic(stream)]
    shape, is_fortran, dtype = read_header(stream)
    start = stream.tell()
    if dtype.hasobject or math.prod(shape) * dtype.itemsize != len(data) - start:
        raise ValueError(f"{len(data) - start} bytes are no {dtype} of shape {shape}")
    return np.frombuffer(data, dtype, offset=start).reshape(shape, order="F" if is_fortran else "C")


_NPY_HEADERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}
"""By format version: 3.0 is for named fields."""
