"""Pairs of pictures of a chessboard, taken by the cameras of a synthetic recording, for calibration.

A flat board needs no renderer: each ray meets its plane at one point.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np
from PIL import Image

from bfsim.errors import RecordingError
from bfsim.recording.frames import StereoGeometry
from bfsim.recording.scenes.lens import Lens, Light, Misfit, bent_points, mean_of_parts, turned
from bfsim.recording.scenes.pinhole import Pinhole, Vector, stereo_pair
from bfsim.recording.scenes.sensor import expose

# Reflectance times light of the board's two colours and of the background. [assumed]
_BLACK, _WHITE, _BEHIND = 0.03, 0.60, 0.12

# Parts of a pixel along each side. [assumed]
_FINENESS = 4

# How the board is held: its width as a part of the picture's, its position in the picture, and how far it is turned
# either way round right, down and forward. [assumed]
_WIDTHS = (0.7, 0.6, 0.5)
_PLACES = tuple(product((-1, 0, 1), repeat=2))
_MOST_TURN_DEG = (35.0, 35.0, 15.0)


@dataclass(frozen=True, slots=True)
class Chessboard:
    """A board of `corners` (across, down) inner corners, with a white margin one square wide around it."""

    corners: tuple[int, int] = (9, 6)
    square_mm: float = 20.0

    @property
    def half_mm(self) -> Vector:
        """Return half the width and height of all its squares together (2,)."""
        return (np.array(self.corners) + 1) * self.square_mm / 2

    def seen_by(self, camera: Pinhole, lens: Lens, held: Pinhole) -> Light:
        """Return the light (height, width, 1) of a board whose right, down and normal are the axes of `held`."""
        points = bent_points(lens, camera.focal_px, camera.width_px, camera.height_px, _FINENESS)
        # In the board's own axes, a ray meets the board where its depth along the normal is 0.
        axes = camera.rotation @ held.rotation.T
        rays = (points @ axes[:2] + axes[2]).astype(np.float32)
        start_mm = held.from_world(camera.position_mm).astype(np.float32)
        across, down = (start_mm[axis] - start_mm[2] * rays[..., axis] / rays[..., 2] for axis in (0, 1))
        half_x, half_y = self.half_mm.tolist()
        odd = (np.floor((across + half_x) / self.square_mm) + np.floor((down + half_y) / self.square_mm)) % 2
        beyond_mm = np.maximum(np.abs(across) - half_x, np.abs(down) - half_y)
        light = np.where(odd == 0, np.float32(_BLACK), np.float32(_WHITE))
        light[beyond_mm > 0] = _WHITE
        light[beyond_mm > self.square_mm] = _BEHIND
        return mean_of_parts(light[..., None], _FINENESS)


def write_chessboards(
    folder: Path, geometry: StereoGeometry, misfit: Misfit, *, seed: int, board: Chessboard | None = None
) -> int:
    """Write left_00.png, right_00.png and so on to `folder`; return how many pairs.

    Raises RecordingError.
    """
    board = board or Chessboard()
    rng = np.random.default_rng(seed)
    left, right = stereo_pair(np.zeros(3), heading_deg=0, geometry=geometry)
    eyes = {"left": left, "right": misfit.misplaced(right)}
    ways = list(product(_WIDTHS, _PLACES))
    for index, (width, place) in enumerate(ways):
        held = _held(left, geometry, board, width, np.array(place), rng)
        for side, eye in eyes.items():
            light = board.seen_by(eye, misfit.lens, held)
            path = folder / f"{side}_{index:02}.png"
            try:
                Image.fromarray(expose(light, rng)[..., 0]).save(path)
            except OSError as error:
                raise RecordingError(f"{path}: picture must be writable: {error.strerror}") from None
    return len(ways)


def _held(
    left: Pinhole,
    geometry: StereoGeometry,
    board: Chessboard,
    width: float,
    place: Vector,
    rng: np.random.Generator,
) -> Pinhole:
    """Return the axes of a board that both cameras see completely, turned at random."""
    picture_px = np.array([left.width_px, left.height_px])
    board_mm = 2 * (board.half_mm + board.square_mm)
    depth_mm = left.focal_px * board_mm[0] / (width * picture_px[0])
    free_mm = picture_px * depth_mm / left.focal_px - board_mm - np.array([geometry.baseline_mm, 0])
    aside_mm = place * np.maximum(free_mm, 0) / 2
    middle_mm = left.position_mm + left.rotation[0] * geometry.baseline_mm / 2
    rotation = left.rotation
    for axis, most_deg in enumerate(_MOST_TURN_DEG):
        rotation = turned(rotation, axis, rng.uniform(-most_deg, most_deg))
    return replace(
        left,
        position_mm=middle_mm + aside_mm @ left.rotation[:2] + depth_mm * left.rotation[2],
        rotation=rotation,
    )
