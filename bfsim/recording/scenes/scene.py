"""A scene as data: its things, its light, and the pose of the cameras in each frame."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from bfsim.errors import RecordingError
from bfsim.recording.frames import StereoGeometry
from bfsim.recording.scenes.drive import Pose
from bfsim.recording.scenes.objects import Colour, FieldArc, FieldLine, Lamp, Thing


@dataclass(frozen=True, slots=True, kw_only=True)
class Light:
    """Lamps, and the radiance of the room behind everything; 1 just saturates the sensor."""

    lamps: tuple[Lamp, ...]
    room_radiance: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Floor:
    """The floor, with its middle at the origin, and the paint on it."""

    size_mm: tuple[float, float]
    colour: Colour
    roughness: float
    paint: Colour
    lines: tuple[FieldLine, ...] = ()
    arcs: tuple[FieldArc, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """A scene that does not change while the cameras take its frames, one from each pose.

    `things` have their names in the ground truth; `roughness` is that of their coats. Frame k is taken `k * period_ns`
    after the first, its red, green and blue light multiplied by `gains[k]`; without gains the camera's white balance is
    right. The right camera's time stamps come `right_phase_ns` later, but both pictures are rendered at the pose of the
    left, so that each pair is exact.
    """

    description: str
    things: Mapping[str, Thing]
    roughness: float
    floor: Floor
    light: Light
    geometry: StereoGeometry
    poses: tuple[Pose, ...]
    period_ns: int
    right_phase_ns: int
    samples: int
    seed: int
    gains: tuple[Colour, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneAtDistances:
    """A scene with a frame for each of some distances: `at` makes it, the other fields are its defaults."""

    at: Callable[[Sequence[float], StereoGeometry], Scene]
    distances_mm: tuple[float, ...]
    geometry: StereoGeometry

    def scene(
        self, distances_mm: Sequence[float] | None = None, geometry: StereoGeometry | None = None
    ) -> Scene:
        """Return the scene for these distances and this geometry. Raises RecordingError if they are impossible."""
        distances_mm = self.distances_mm if distances_mm is None else distances_mm
        if not all(0 < distance < math.inf for distance in distances_mm or (0,)):
            listed = ", ".join(f"{distance:g}" for distance in distances_mm) or "none"
            raise RecordingError(f"distances must be at least one and above 0 mm, not {listed}")
        return self.at(distances_mm, geometry or self.geometry)


Scenes = Scene | SceneAtDistances | Mapping[str, Scene]
"""What can be rendered: a single recording, or one for each name."""
