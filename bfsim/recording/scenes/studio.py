"""Render a scene to a recording: exact ground truth, then light, lens and sensor."""

from __future__ import annotations

import os
from collections.abc import Callable

import numpy as np
from PIL import Image

from bfsim.recording.frames import UyvyImage
from bfsim.recording.planes import YuvPlanes
from bfsim.recording.scenes import lens
from bfsim.recording.scenes.lens import Light, Misfit
from bfsim.recording.scenes.objects import Colour
from bfsim.recording.scenes.pinhole import HEIGHT_PX, WIDTH_PX, Pinhole
from bfsim.recording.scenes.renderer import Renderer
from bfsim.recording.scenes.scene import Scene
from bfsim.recording.scenes.sensor import expose
from bfsim.recording.scenes.shapes import scene_shapes
from bfsim.recording.scenes.truth import disparity, frame_truth
from bfsim.recording.writer import RecordingWriter

_DESCRIPTION = (
    "{scene} Rendered by {renderer}, {samples} samples a pixel, seed {seed}. Both pictures of a frame are "
    "rendered at the pose of the left time stamp, so that each pair is exact. Ground truth: lengths in mm, x "
    "towards the far goal, y left, z up, origin on the floor; pixels as array indices, (0, 0) the centre of the "
    "first."
)
_MISFIT = (
    " Taken through lenses with k1 {0.k1:g}, k2 {0.k2:g}, p1 {0.p1:g}, p2 {0.p2:g}, the right camera turned by {1} "
    "degrees and shifted by {2} mm (right, down, forward); the ground truth is that of the rectified pictures."
)


def record_scene(
    scene: Scene,
    path: str | os.PathLike[str],
    *,
    frames: int | None = None,
    samples: int | None = None,
    misfit: Misfit | None = None,
    progress: Callable[[int], None] | None = None,
) -> None:
    """Render a scene to the recording `path`: its first `frames` frames or all, with `samples` a pixel or its own.

    With a misfit the pictures are those of a real pair of cameras; the ground truth is for the rectified pictures.
    `progress` gets the number of frames done. Raises RecordingError.
    """
    renderer = Renderer(scene_shapes(scene))
    poses, samples = scene.poses[:frames], samples or scene.samples
    description = _DESCRIPTION.format(
        scene=scene.description, renderer=renderer.version, samples=samples, seed=scene.seed
    )
    if misfit is not None:
        description += _MISFIT.format(misfit.lens, misfit.turn_deg, misfit.shift_mm)
    with RecordingWriter(
        path, width=WIDTH_PX, height=HEIGHT_PX, geometry=scene.geometry, description=description
    ) as recording:
        for index, pose in enumerate(poses):
            seeds = scene.seed + 2 * index, scene.seed + 2 * index + 1
            if index == 0 or pose != poses[index - 1]:  # from the same pose the light is the same
                cameras = ideal = pose.cameras(scene.geometry)
                if misfit is not None:
                    cameras = {**cameras, "right": misfit.misplaced(cameras["right"])}
                    ideal = lens.rectified(cameras)
                lights = [
                    _light(renderer, camera, misfit, samples=samples, seed=seed)
                    for camera, seed in zip(cameras.values(), seeds, strict=True)
                ]
                known = frame_truth(scene, ideal, renderer.sees)
                disparity_px = disparity(renderer.depths_mm(ideal["left"]), ideal)
            gains = scene.gains[index] if scene.gains else (1.0, 1.0, 1.0)
            left, right = (_sent(light, gains, seed) for light, seed in zip(lights, seeds, strict=True))
            left_ns = index * scene.period_ns
            recording.add(left, right, left_ns, left_ns + scene.right_phase_ns, known, disparity_px)
            if progress is not None:
                progress(index + 1)


def _light(renderer: Renderer, camera: Pinhole, misfit: Misfit | None, *, samples: int, seed: int) -> Light:
    """Return the light that reaches the sensor."""
    if misfit is None:
        return renderer.look(camera, samples=samples, seed=seed)
    finer = max(1, samples // lens.FINENESS**2)
    return lens.through(misfit.lens, camera, lambda view: renderer.look(view, samples=finer, seed=seed))


def _sent(light: Light, gains: Colour, seed: int) -> UyvyImage:
    """Return the picture that the camera makes of the light and sends."""
    picture = expose(light * np.array(gains, np.float32), np.random.default_rng(seed))
    return YuvPlanes.from_image(Image.fromarray(picture)).to_uyvy()
