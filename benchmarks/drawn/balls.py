"""Balls drawn by formulas: spheres of known image under known light, on a known floor, through a known lens.

The camera is the thesis's, and the image of a sphere an ellipse, longer along the way to the middle of the picture. Every ball is
painted `SAMPLES` by `SAMPLES` times finer than the picture, blurred there, and only then sampled, so that centre
and radius are true to a hundredth of a pixel. Light is Lambert's: ambient light, and some that falls off with the cosine to
the sun. The firmware's thresholds were set on other pictures. Needs OpenCV.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.sparse import csr_array

from bfsim.recording import StereoFrame
from bfsim.recording.planes import YuvPlanes

Rgb = tuple[float, float, float]
Canvas = NDArray[np.float64]

SAMPLES = 5
SIZE = (320, 240)
FOCAL_PX = 386.0  # what the firmware assumes of a recording that does not say it
PRINCIPAL = (np.array(SIZE) - 1) / 2
ROUNDS = 12
CELLS = (3, 2)
"""Balls side by side and one above the other in a picture."""

# The balls have the middle of a hue of the firmware, but for one whose hue is between two.
BRIGHT_BALL: Rgb = (225, 189, 20)
DARK_BALL: Rgb = (150, 126, 12)
BETWEEN_HUES: Rgb = (225, 170, 20)
DARK_FLOOR: Rgb = (40, 42, 40)
MIDDLE_FLOOR: Rgb = (104, 106, 104)
BRIGHT_FLOOR: Rgb = (190, 192, 190)


@dataclass(frozen=True, slots=True)
class Condition:
    """What the balls of a row of the table have in common. Lengths in px; `sun` points to the light, (right, down, to the camera).

    `ambient`: the part of the light that comes from everywhere. `texture`: standard deviation of the floor in grey levels.
    `shadow`: how much of the light the floor beneath the ball lacks. `noise`: of the camera, in grey levels.
    """

    name: str
    ball: Rgb = BRIGHT_BALL
    floor: Rgb = DARK_FLOOR
    blur: float = 0.7
    sun: tuple[float, float, float] = (0.0, 0.0, 1.0)
    ambient: float = 1.0
    texture: float = 0.0
    shadow: float = 0.0
    noise: float = 1.5


@dataclass(frozen=True, slots=True)
class Ball:
    """Where the image of a ball is, in px: the middle of the ellipse, and the mean of its half axes."""

    x: float
    y: float
    radius: float


@dataclass(frozen=True, slots=True)
class Sphere:
    """A ball at a distance of 1 from the camera: where its middle is, (right, down, forwards), and its radius."""

    middle: NDArray[np.float64]
    radius: float

    @classmethod
    def of(cls, ball: Ball) -> Sphere:
        """Return the sphere with this image."""
        off = np.array([ball.x, ball.y]) - PRINCIPAL
        far = float(np.hypot(*off))
        # how far the middle is off the axis, and how wide the ball is, as angles; the ellipse says how wrong they are
        aside, wide = math.atan(far / FOCAL_PX), math.atan(ball.radius / FOCAL_PX)
        for _ in range(ROUNDS):
            both = math.cos(2 * aside) + math.cos(2 * wide)
            along = FOCAL_PX * math.sin(2 * wide) / both
            across = FOCAL_PX * math.sin(wide) * math.sqrt(2 / both)
            wide *= 2 * ball.radius / (along + across)
            aside *= far / (FOCAL_PX * math.sin(2 * aside) / both) if far else 1
        forwards = np.array([0, 0, math.cos(aside)])
        return cls(forwards + np.append(off, 0) * (math.sin(aside) / far if far else 0), math.sin(wide))


def blurred(canvas: Canvas, px: float) -> Canvas:
    """Blur a canvas by a Gauss of so many px of the picture."""
    return np.asarray(cv2.GaussianBlur(canvas, (0, 0), px * SAMPLES))


def lit(ball: Ball, x: Canvas, y: Canvas, condition: Condition) -> tuple[NDArray[np.bool_], Canvas]:
    """Return which points a ball covers, and how bright they are, of 1."""
    sphere = Sphere.of(ball)
    across, down = np.broadcast_arrays((x - PRINCIPAL[0]) / FOCAL_PX, (y - PRINCIPAL[1]) / FOCAL_PX)
    rays = np.stack([across, down, np.ones_like(across)], axis=-1)
    length = (rays**2).sum(axis=-1)
    nearest = rays @ sphere.middle
    inside = nearest**2 - length * (1 - sphere.radius**2)
    reach = (nearest - np.sqrt(np.maximum(inside, 0))) / length
    normals = (reach[..., None] * rays - sphere.middle) / sphere.radius
    sun = np.array(condition.sun) * (1, 1, -1) / np.linalg.norm(condition.sun)
    cosine = np.maximum(normals @ sun, 0)
    return inside >= 0, condition.ambient + (1 - condition.ambient) * cosine


def shade_of(ball: Ball, x: Canvas, y: Canvas, condition: Condition) -> Canvas:
    """Return how bright the floor is, of 1: a soft ellipse under the ball, away from the sun, is darker."""
    off_x = (x - ball.x + 0.6 * ball.radius * condition.sun[0]) / (1.1 * ball.radius)
    off_y = (y - ball.y - 0.9 * ball.radius) / (0.4 * ball.radius)
    inside = np.clip((1.15 - np.hypot(off_x, off_y)) / 0.3, 0, 1)
    return np.asarray(1 - condition.shadow * inside)


def picture_of(balls: Sequence[Ball], condition: Condition, seed: int) -> Image.Image:
    """Draw balls on a floor."""
    chance = np.random.default_rng(seed)
    width, height = SIZE
    x, y = ((np.arange(pixels * SAMPLES) + 0.5) / SAMPLES - 0.5 for pixels in SIZE)
    canvas = np.empty((len(y), len(x), 3))
    canvas[:] = condition.floor
    if condition.texture:
        canvas += condition.texture * _grain(seed % 4)[..., None]
    for ball in balls:
        rows, columns = _around(ball)
        _paint(ball, canvas[rows, columns], x[columns], y[rows, None], condition)
    # one axis after the other: a row of the picture is a sum of rows of the canvas, and so is a column
    rows_done = _lens(height, condition.blur) @ canvas.reshape(len(y), -1)
    columns_first = rows_done.reshape(height, len(x), 3).swapaxes(0, 1).reshape(len(x), -1)
    pixels = (_lens(width, condition.blur) @ columns_first).reshape(width, height, 3).swapaxes(0, 1)
    pixels = pixels + chance.normal(0, condition.noise, pixels.shape)
    return Image.fromarray(np.rint(np.clip(pixels, 0, 255)).astype(np.uint8))


@cache
def _lens(pixels: int, blur: float) -> csr_array:
    """Return what makes `pixels` rows of a picture of the rows of the canvas: each is the mean of `SAMPLES` blurred rows."""
    mean = np.repeat(np.eye(pixels), SAMPLES, axis=1) / SAMPLES
    if not blur:
        return csr_array(mean)
    reach = round(4 * blur * SAMPLES)  # as `blurred` has it
    rows = np.eye(pixels * SAMPLES)
    return csr_array(mean @ cv2.GaussianBlur(rows, (1, 2 * reach + 1), blur * SAMPLES))


def _around(ball: Ball) -> tuple[slice, slice]:
    """Return the part of the canvas that a ball and its shadow lie in."""
    reach = 2 * ball.radius + 4
    rows, columns = (
        slice(max(round((middle - reach) * SAMPLES), 0), round((middle + reach) * SAMPLES))
        for middle in (ball.y, ball.x)
    )
    return rows, columns


def _paint(ball: Ball, canvas: Canvas, x: Canvas, y: Canvas, condition: Condition) -> None:
    if condition.shadow:
        canvas *= shade_of(ball, x, y, condition)[..., None]
    inside, brightness = lit(ball, x, y, condition)
    canvas[inside] = brightness[inside, None] * condition.ball


@cache
def _grain(seed: int) -> Canvas:
    """Return grains of 2 to 8 px, of mean 0 and deviation 1."""
    chance = np.random.default_rng(seed)
    shape = SIZE[1] * SAMPLES, SIZE[0] * SAMPLES
    grain = sum(each / each.std() for each in (blurred(chance.normal(0, 1, shape), px) for px in (1.0, 3.0)))
    return np.asarray(grain / np.std(grain))


def scatter(least: float, most: float, seed: int) -> list[Ball]:
    """Return a ball for each cell of a picture, of any radius between two, evenly by its logarithm, anywhere in its cell."""
    chance = np.random.default_rng(seed)
    wide, high = (pixels / cells for pixels, cells in zip(SIZE, CELLS, strict=True))
    found = []
    for row in range(CELLS[1]):
        for column in range(CELLS[0]):
            radius = float(np.exp(chance.uniform(np.log(least), np.log(most))))
            slack_x, slack_y = (max(each / 2 - radius - 9, 1) for each in (wide, high))
            x = (column + 0.5) * wide + chance.uniform(-slack_x, slack_x)
            y = (row + 0.5) * high + chance.uniform(-slack_y, slack_y)
            found.append(Ball(x, y, radius))
    return found


def frame_of(condition: Condition, least: float, most: float, number: int) -> StereoFrame:
    """Return a frame whose cameras see different balls; its truth names those of each."""
    balls = {side: scatter(least, most, 2 * number + each) for each, side in enumerate(("left", "right"))}
    coded = [
        YuvPlanes.from_image(picture_of(each, condition, 2 * number + side)).to_uyvy()
        for side, each in enumerate(balls.values())
    ]
    truth = {side: [(each.x, each.y, each.radius) for each in of] for side, of in balls.items()}
    at_ns = number * 40_000_000
    return StereoFrame(number, *coded, left_ns=at_ns, right_ns=at_ns, truth=truth)
