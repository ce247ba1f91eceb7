"""Check the messages of a recording and return them as plain data. A RecordingError says `where` the message is."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from google.protobuf.message import DecodeError
from mcap.records import Message

from bfsim.errors import RecordingError, cut, shown
from bfsim.recording import layout
from bfsim.recording.frames import DisparityImage, UyvyImage


def picture_of(message: Message, width: int, height: int, where: str) -> UyvyImage:
    """Return a camera's picture: read-only UYVY bytes, (height, 2 · width).

    Raises RecordingError, which says `where`, unless the message is an image of the given size in pixels.
    """
    image = image_of(message, where)
    if (image.width, image.height) != (width, height):
        raise RecordingError(
            f"every image must have the size of the first, {width}x{height}, "
            f"not {image.width}x{image.height} {where}"
        )
    rows = np.frombuffer(image.data, np.uint8).reshape(image.height, image.step)
    return rows[:, : 2 * image.width]


def truth_of(message: Message, where: str) -> Mapping[str, Any]:
    """Return the ground truth of a frame. Raises RecordingError unless it is a JSON object."""
    try:
        truth = json.loads(message.data)
    except (ValueError, RecursionError) as error:
        raise RecordingError(f"ground truth must be JSON: {cut(str(error))} {where}") from None
    if not isinstance(truth, dict):
        raise RecordingError(f"ground truth must be a JSON object, not {type(truth).__name__} {where}")
    return truth


def disparity_of(message: Message, width: int, height: int, where: str) -> DisparityImage:
    """Return the exact disparities of a frame in pixels, float32, (height, width).

    Raises RecordingError unless they are as many as the pictures, of the given size, have pixels.
    """
    image = _parsed(message, where)
    found = (image.encoding, image.width, image.height, len(image.data))
    wanted = (layout.DISPARITY_ENCODING, width, height, 4 * width * height)
    if found != wanted:
        raise RecordingError(
            "disparity must have encoding, width, height and bytes of "
            f"{', '.join(map(str, wanted))}, not {', '.join(map(str, found))} {where}"
        )
    return np.frombuffer(image.data, "<f4").reshape(height, width)


def image_of(message: Message, where: str) -> RawImage:
    """Return a camera's message as an image. Raises RecordingError unless its sizes match each other and its data."""
    image = _parsed(message, where)
    if image.encoding not in layout.IMAGE_ENCODINGS:
        raise RecordingError(f"image must be in UYVY (encoding 'uyvy'), not {shown(image.encoding)} {where}")
    if image.width == 0 or image.height == 0 or image.width % 2:
        raise RecordingError(
            f"image width must be even (UYVY pixels come in pairs) and no side 0, "
            f"not {image.width}x{image.height} {where}"
        )
    if len(image.data) > layout.LARGEST_PICTURE_BYTES:
        raise RecordingError(
            f"image must have at most {layout.LARGEST_PICTURE_BYTES >> 20} MiB, not {image.width}x{image.height} pixels "
            f"in {len(image.data)} bytes {where}"
        )
    if image.step < 2 * image.width:
        raise RecordingError(
            f"UYVY image of width {image.width} must have rows of at least {2 * image.width} bytes, "
            f"not {image.step} {where}"
        )
    if len(image.data) != image.step * image.height:
        raise RecordingError(
            f"image of {image.height} rows of {image.step} bytes must have {image.step * image.height} "
            f"bytes, not {len(image.data)} {where}"
        )
    return image


def _parsed(message: Message, where: str) -> RawImage:
    try:
        image: RawImage = RawImage.FromString(message.data)
    except DecodeError:
        raise RecordingError(
            f"image must be a {layout.IMAGE_SCHEMA} message, not {len(message.data)} other bytes {where}"
        ) from None
    return image
