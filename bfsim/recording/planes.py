"""Pictures as separate brightness and colour planes, and their conversion to the camera's UYVY.

UYVY here is BT.601 in full range (0 to 255), as JPEG has it and as OmniVision sensors send it with output
range "00 to FF" (register COM15, the setting of the Linux driver ov7670.c for YUV). One colour sample serves
two neighbouring pixels and is their mean, so it sits midway between them; 4:2:0 colour rows are used twice.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from bfsim.recording.frames import UyvyImage

Plane = NDArray[np.uint8]

# R, G, B (rows) to Y, U, V (columns) in 1/65536: BT.601 as in JFIF 1.02, rounded as in libjpeg's jccolor.c.
# Pillow's own YCbCr truncates instead, and turns grey 11 into 10.
_RGB_TO_YUV = np.array([[19595, -11059, 32768], [38470, -21709, -27439], [7471, 32768, -5329]], np.int32)
_YUV_OFFSET = np.array([1 << 15, (128 << 16) + (1 << 15) - 1, (128 << 16) + (1 << 15) - 1], np.int32)


@dataclass(frozen=True, slots=True)
class YuvPlanes:
    """One picture: y is (height, width); u and v are the same, half as wide, or half as wide and high."""

    y: Plane
    u: Plane
    v: Plane

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.y.shape[1], self.y.shape[0]

    def halves(self) -> tuple[YuvPlanes, YuvPlanes]:
        """The left and the right half of a picture of two cameras side by side, whose width must be 4 x n."""
        pairs = [np.split(plane, 2, axis=1) for plane in (self.y, self.u, self.v)]
        return YuvPlanes(*(pair[0] for pair in pairs)), YuvPlanes(*(pair[1] for pair in pairs))

    def resized(self, width: int, height: int) -> YuvPlanes:
        """Return the picture scaled to width x height (4:2:2); whatever is outside that shape is cut off evenly.

        Shapes are kept (a ball stays round), and the triangle filter does not create edges by ringing.
        """
        cut = _centred_cut(self.size, (width, height))
        return YuvPlanes(
            _scaled(self.y, (width, height), cut),
            _scaled(self.u, (width // 2, height), cut),
            _scaled(self.v, (width // 2, height), cut),
        )

    def cropped(self, width: int, height: int) -> YuvPlanes:
        """Return the middle width x height of the picture, which must be as large; a pixel left or up for colours."""
        left, top = ((have - want) // 4 * 2 for have, want in zip(self.size, (width, height), strict=True))
        own_width, own_height = self.size

        def cut(plane: Plane) -> Plane:
            across, down = -(-own_width // plane.shape[1]), -(-own_height // plane.shape[0])
            return plane[
                top // down : -(-(top + height) // down), left // across : -(-(left + width) // across)
            ]

        return YuvPlanes(cut(self.y), cut(self.u), cut(self.v))

    def to_uyvy(self) -> UyvyImage:
        """Return the picture, of even width, as the camera sends it: uint8 of shape (height, 2 * width)."""
        width, height = self.size
        uyvy = np.empty((height, width // 2, 4), np.uint8)
        uyvy[..., 0] = _chroma_422(self.u, width, height)
        uyvy[..., 1] = self.y[:, 0::2]
        uyvy[..., 2] = _chroma_422(self.v, width, height)
        uyvy[..., 3] = self.y[:, 1::2]
        return uyvy.reshape(height, 2 * width)

    @classmethod
    def from_uyvy(cls, uyvy: UyvyImage) -> YuvPlanes:
        """Return the planes (4:2:2) of a picture of shape (height, 2 * width)."""
        return cls(uyvy[:, 1::2], uyvy[:, 0::4], uyvy[:, 2::4])

    @classmethod
    def from_yuyv(cls, yuyv: NDArray[np.uint8]) -> YuvPlanes:
        """Return the planes (4:2:2) of a picture of shape (height, 2 * width) from a USB camera: Y before U and V."""
        return cls(yuyv[:, 0::2], yuyv[:, 1::4], yuyv[:, 3::4])

    @classmethod
    def from_grey(cls, y: Plane) -> YuvPlanes:
        """Return the planes of a picture without colour."""
        grey = np.full_like(y, 128)
        return cls(y, grey, grey)

    @classmethod
    def from_image(cls, image: Image.Image) -> YuvPlanes:
        """Return the planes (4:4:4) of an image of 8 bits a channel."""
        rgb = np.asarray(image.convert("RGB"), np.int32)
        yuv = ((rgb @ _RGB_TO_YUV + _YUV_OFFSET) >> 16).astype(np.uint8)
        return cls(yuv[..., 0], yuv[..., 1], yuv[..., 2])

    def stretched(self) -> YuvPlanes:
        """Return the picture stretched from limited range (16 to 235, colour 16 to 240 [BT.601]) to full range."""
        levels = np.arange(256)
        y_levels = np.clip(np.rint((levels - 16) * 255 / 219), 0, 255).astype(np.uint8)
        chroma_levels = np.clip(np.rint((levels - 128) * 255 / 224 + 128), 0, 255).astype(np.uint8)
        return YuvPlanes(y_levels[self.y], chroma_levels[self.u], chroma_levels[self.v])


def fit_matrix(
    size: tuple[int, int], resize: tuple[int, int] | None, crop: tuple[int, int] | None
) -> NDArray[np.float64]:
    """Return the matrix (3, 3) from pixels of a picture to those after `resized(*resize)`, `cropped(*crop)` or neither.

    Pixels are counted at their centres.
    """
    if resize:
        parts = zip(size, resize, _centred_cut(size, resize), strict=True)
        axes = [(have * (1 - cut) / 2, want / (have * cut)) for have, want, cut in parts]
    elif crop:
        axes = [((have - want) // 4 * 2, 1.0) for have, want in zip(size, crop, strict=True)]
    else:
        return np.eye(3)
    (left, across), (top, down) = axes
    return np.array(
        [[across, 0, (0.5 - left) * across - 0.5], [0, down, (0.5 - top) * down - 0.5], [0, 0, 1]]
    )


def _chroma_422(plane: Plane, width: int, height: int) -> Plane:
    """Return a colour plane as (height, width / 2): pairs of columns averaged, missing rows repeated."""
    if plane.shape[0] != height:
        plane = plane.repeat(2, axis=0)[:height]
    if plane.shape[1] == width:
        pairs = plane.reshape(height, width // 2, 2).astype(np.uint16)
        plane = ((pairs[..., 0] + pairs[..., 1] + 1) >> 1).astype(np.uint8)
    return plane


def _centred_cut(source: tuple[int, int], target: tuple[int, int]) -> tuple[float, float]:
    """Return the fractions (0 to 1) of the source's width and height that have the target's aspect ratio."""
    aspect = (target[0] * source[1]) / (target[1] * source[0])
    return min(1.0, aspect), min(1.0, 1 / aspect)


def _scaled(plane: Plane, size: tuple[int, int], cut: tuple[float, float]) -> Plane:
    height, width = plane.shape
    left, top = width * (1 - cut[0]) / 2, height * (1 - cut[1]) / 2
    box = (left, top, width - left, height - top)
    return np.asarray(
        Image.fromarray(np.ascontiguousarray(plane)).resize(size, Image.Resampling.BILINEAR, box=box)
    )
