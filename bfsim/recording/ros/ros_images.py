"""Pictures of ROS: the messages sensor_msgs/Image and sensor_msgs/CompressedImage → planes."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from bfsim.errors import RecordingError, shown
from bfsim.recording.importing.bayer import BAYER_PATTERNS, planes_of_bayer
from bfsim.recording.importing.deep_pixels import upper_bits, words
from bfsim.recording.importing.image_files import decoded
from bfsim.recording.layout import LARGEST_PICTURE_BYTES
from bfsim.recording.planes import YuvPlanes

IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
IMAGE_TYPES = (IMAGE, COMPRESSED)

_UNORDERED = {"8UC3": "BGR", "8UC4": "BGRA"}
"""OpenCV's names for pixels of unspecified colours, in the order in which OpenCV itself, and rviz, take them."""
_COLOURS = {"rgb8": "RGB", "bgr8": "BGR", "rgba8": "RGBA", "bgra8": "BGRA", **_UNORDERED}
"""Order of the bytes of a pixel."""
_YUV = {"yuv422": "UYVY", "uyvy": "UYVY", "yuv422_yuy2": "YUYV", "yuyv": "YUYV"}
"""Order of the bytes of two pixels: sensor_msgs/image_encodings."""
_GREY = ("mono8", "8UC1")
_DEEP = {"mono16": "", "16UC1": "", **{f"{each.removesuffix('8')}16": each for each in BAYER_PATTERNS}}
"""16-bit pixels: the pattern that their 8-bit version has, if any."""
ENCODINGS = (*_GREY, *_COLOURS, *_YUV, *BAYER_PATTERNS, *_DEEP)
_PIXEL_BYTES: dict[str, int] = {**dict.fromkeys(_GREY, 1), **{each: len(order) for each, order in _COLOURS.items()},
                **dict.fromkeys(_YUV, 2), **dict.fromkeys(BAYER_PATTERNS, 1), **dict.fromkeys(_DEEP, 2)}  # fmt: skip


def planes_of(message: Any, kind: str, bits: int | None = None) -> YuvPlanes:
    """Return the picture in a message of one of IMAGE_TYPES. YUV is taken as it is, in full range.

    `bits`: how many the camera uses of 16-bit pixels.

    Raises RecordingError for other encodings, and if the bytes do not form such a picture.
    """
    if kind == COMPRESSED:
        return YuvPlanes.from_image(decoded(BytesIO(message.data), ("JPEG", "PNG"), bits=bits))
    encoding, width, height = message.encoding, message.width, message.height
    if encoding not in ENCODINGS:
        raise RecordingError(f"encoding must be one of {', '.join(ENCODINGS)}, not {shown(encoding)}")
    pixels = _pixels(message, _PIXEL_BYTES[encoding])
    if encoding in _DEEP:
        deep = words(pixels.tobytes(), (height, width), is_big_endian=bool(message.is_bigendian))
        pixels, pattern = upper_bits(deep, bits), _DEEP[encoding]
        return planes_of_bayer(pixels, pattern) if pattern else YuvPlanes.from_grey(pixels)
    if bits is not None:
        raise RecordingError(
            f"encoding must be one of {', '.join(_DEEP)} for `--bits {bits}`, not {encoding}"
        )
    if encoding in _GREY:
        return YuvPlanes.from_grey(pixels)
    if encoding in _COLOURS:
        places = [_COLOURS[encoding].index(each) for each in "RGB"]
        colours = pixels.reshape(height, width, -1)[..., places]
        return YuvPlanes.from_image(Image.fromarray(np.ascontiguousarray(colours)))
    if encoding in BAYER_PATTERNS:
        return planes_of_bayer(pixels, encoding)
    if width % 2:
        raise RecordingError(f"{encoding} must have an even width, not {width}")
    return YuvPlanes.from_yuyv(pixels) if _YUV[encoding] == "YUYV" else YuvPlanes.from_uyvy(pixels)


def order_note(encoding: str) -> str:
    """Return a note about an encoding with an unspecified order of colours, else ""."""
    order = _UNORDERED.get(encoding)
    return f"{encoding} says no order of colours: {order} is taken, as OpenCV has it." if order else ""


def _pixels(message: Any, pixel_bytes: int) -> NDArray[np.uint8]:
    """Return the rows (height, width x bytes of a pixel) without their padding."""
    width, height, step = message.width, message.height, message.step
    if min(width, height) < 1 or width * height * pixel_bytes > LARGEST_PICTURE_BYTES:
        raise RecordingError(
            f"picture must have 1 pixel at least and {LARGEST_PICTURE_BYTES:,} bytes at most, not be {width}x{height}"
        )
    if step < width * pixel_bytes or len(message.data) < step * height:
        raise RecordingError(
            f"picture of {width}x{height} must have rows of {width * pixel_bytes} bytes or more and {height} of them, not "
            f"{len(message.data):,} bytes in rows of {step:,}"
        )
    rows = np.asarray(message.data, np.uint8)[: step * height].reshape(height, step)
    return rows[:, : width * pixel_bytes]
