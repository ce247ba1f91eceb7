"""Renders a scene to a recording: exact ground truth, then light, lens and sensor."""

from __future__ import annotations

import os
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from bfsim.recording.frames import UyvyImage
from bfsim.recording.planes import YuvPlanes
from bfsim.recording.scenes import lens
from bfsim.recording.scenes.lens import Lens, Misfit
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
    progress: Callable[[int, int | None], None] | None = None,
) -> None:
    """Render a scene to the recording `path`: its first `frames` frames or all, `samples` a pixel or its own.

    With a misfit the pictures are those of a real pair of cameras; the ground truth is what rectification
    brings back. Raises RecordingError.
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
            cameras = ideal = pose.cameras(scene.geometry)
            if misfit is not None:
                cameras = {**cameras, "right": misfit.misplaced(cameras["right"])}
                ideal = lens.rectified(cameras)
            left, right = (
                _photograph(renderer, camera, scene, misfit, samples=samples, index=index, eye=eye)
                for eye, camera in enumerate(cameras.values())
            )
            left_ns = index * scene.period_ns
            recording.add(
                left,
                right,
                left_ns,
                left_ns + scene.right_phase_ns,
                frame_truth(scene, ideal, renderer.sees),
                disparity(renderer.depths_mm(ideal["left"]), ideal),
            )
            if progress is not None:
                progress(index + 1, len(poses))


def photograph(
    look: Callable[[Pinhole], NDArray[np.float32]],
    camera: Pinhole,
    bent_by: Lens | None,
) -> NDArray[np.float32]:
    """Return the light (height, width, 3) behind a lens, or straight without one.

    `look` gives the light that reaches an ideal camera.
    """
    if bent_by is None:
        return look(camera)
    bent = lens.bent_pixels(camera, bent_by)
    view = lens.wide_view(camera, bent)
    return lens.look_up(look(view), view, bent)


def _photograph(
    renderer: Renderer,
    camera: Pinhole,
    scene: Scene,
    misfit: Misfit | None,
    *,
    samples: int,
    index: int,
    eye: int,
) -> UyvyImage:
    seed = scene.seed + 2 * index + eye
    finer = lens.FINENESS**2 if misfit else 1
    light = photograph(
        lambda view: renderer.look(view, samples=max(1, samples // finer), seed=seed),
        camera,
        misfit.lens if misfit else None,
    )
    if scene.gains:
        light = light * np.array(scene.gains[index], np.float32)
    picture = expose(light, np.random.default_rng(seed))
    return YuvPlanes.from_image(Image.fromarray(picture)).to_uyvy()
