"""Pictures from files without a container: raw frames back to back, as cameras send them. Their bytes are kept as they are."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import RecordingError
from bfsim.recording.importing.bayer import BayerPattern, planes_of_bayer
from bfsim.recording.importing.deep_pixels import are_uppermost, upper_bits, words
from bfsim.recording.importing.planar_frames import PlanarLayout, opened, read_frame
from bfsim.recording.importing.sources import PictureSource, Skipped
from bfsim.recording.planes import YuvPlanes

SWAPPED = "; they would with their bytes the other way round: swap them, as `dd conv=swab` does"


def open_uyvy(source: str, size: tuple[int, int]) -> PictureSource:
    """Open raw UYVY frames of `size` (width, height) in pixels."""
    return _open_packed(source, "UYVY", size, YuvPlanes.from_uyvy)


def open_yuyv(source: str, size: tuple[int, int]) -> PictureSource:
    """Open raw YUYV frames, also called YUY2, of `size` (width, height) in pixels."""
    return _open_packed(source, "YUYV", size, YuvPlanes.from_yuyv)


def _open_packed(
    source: str, name: str, size: tuple[int, int], planes_of: Callable[[NDArray[np.uint8]], YuvPlanes]
) -> PictureSource:
    """Open frames with two bytes a pixel, where two pixels share a colour."""
    width, height = size
    if width % 2:
        raise RecordingError(f"{source}: width of {name} frames must be even, not {width}")

    def planes(data: bytes) -> YuvPlanes:
        return planes_of(np.frombuffer(data, np.uint8).reshape(height, 2 * width))

    return _open_raw(source, name, size, 2 * width * height, planes)


def open_i420(source: str, size: tuple[int, int]) -> PictureSource:
    """Open raw I420 frames (planes Y, U, V; colour halved both ways) of `size` (width, height) in pixels."""
    frame = _quartered(source, "I420", size)
    return _open_raw(source, "I420", size, frame.frame_bytes, frame.planes)


def open_nv12(source: str, size: tuple[int, int]) -> PictureSource:
    """Open raw NV12 frames (a plane Y, one of alternating U and V; colour halved both ways) of `size` (width, height)."""
    frame = _quartered(source, "NV12", size)

    def planes(data: bytes) -> YuvPlanes:
        pixels = np.frombuffer(data, np.uint8)
        luma, chroma = np.split(pixels, [frame.width * frame.height])
        pairs = chroma.reshape(*frame.chroma_shape, 2)
        return YuvPlanes(luma.reshape(frame.height, frame.width), pairs[..., 0], pairs[..., 1])

    return _open_raw(source, "NV12", size, frame.frame_bytes, planes)


def open_grey(source: str, size: tuple[int, int], bits: int | None = None) -> PictureSource:
    """Open raw grey frames of `size` (width, height); pixels have one byte, or two with this many used `bits`."""
    return _open_sensor(source, "grey", size, bits, YuvPlanes.from_grey)


def open_bayer(
    pattern: BayerPattern, source: str, size: tuple[int, int], bits: int | None = None
) -> PictureSource:
    """Open raw frames of a sensor with colour filters on its pixels, like `open_grey`."""
    return _open_sensor(source, pattern, size, bits, partial(planes_of_bayer, pattern=pattern))


def _open_sensor(
    source: str,
    name: str,
    size: tuple[int, int],
    bits: int | None,
    planes_of: Callable[[NDArray[np.uint8]], YuvPlanes],
) -> PictureSource:
    """Open frames with one number a pixel; numbers of two bytes begin with the lower one."""
    width, height = size

    def planes(data: bytes) -> YuvPlanes:
        if bits is None:
            return planes_of(np.frombuffer(data, np.uint8).reshape(height, width))
        pixels = words(data, (height, width))
        try:
            return planes_of(upper_bits(pixels, bits))
        except RecordingError as error:
            fit_swapped = not words(data, (height, width), is_big_endian=True).max() >> bits
            is_swapped = fit_swapped and not are_uppermost(pixels, bits)
            raise RecordingError(f"{error}{SWAPPED if is_swapped else ''}") from None

    return _open_raw(source, name, size, width * height * (1 if bits is None else 2), planes)


def _quartered(source: str, name: str, size: tuple[int, int]) -> PlanarLayout:
    """Return the layout of frames whose colour planes are half as wide and high."""
    width, height = size
    if width % 2 or height % 2:
        raise RecordingError(
            f"{source}: width and height of {name} frames must be even, not {width}x{height}"
        )
    return PlanarLayout(width, height, (2, 2))


def _open_raw(
    source: str, name: str, size: tuple[int, int], frame_bytes: int, planes: Callable[[bytes], YuvPlanes]
) -> PictureSource:
    with opened(source) as stream:
        size_bytes = stream.seek(0, 2)
    count, rest = divmod(size_bytes, frame_bytes)
    if size_bytes == 0 or rest:
        raise RecordingError(
            f"{source}: file must be a whole number of {size[0]}x{size[1]} {name} frames "
            f"of {frame_bytes} bytes, not {size_bytes} bytes: {count} frames and {rest} bytes; "
            "is `--size` right?"
        )

    def pictures() -> Iterator[YuvPlanes | Skipped]:
        with opened(source) as stream:
            for index in range(size_bytes // frame_bytes):
                data = read_frame(stream, frame_bytes, source, index)
                try:
                    yield planes(data)
                except RecordingError as error:
                    yield Skipped(f"{source} {index}", str(error))

    return PictureSource(name=source, size=size, count=size_bytes // frame_bytes, fps=None, pictures=pictures)
