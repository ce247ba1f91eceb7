"""A small interface to Mitsuba: shapes in, linear pictures out. Loaded only when a scene is rendered.

The renderer integrates each pixel over its own square: no lens blur and no motion blur.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.errors import RecordingError
from bfsim.process.signals import cancellable, held_back, uninterrupted
from bfsim.recording.scenes.pinhole import Pinhole, Vector
from bfsim.recording.scenes.shapes import Shape

# Light that came from a lamp over at most three surfaces: enough for colours mirrored in the floor.
MAX_DEPTH = 4


class Renderer:
    """A loaded scene that can be viewed from any camera."""

    def __init__(self, shapes: Mapping[str, Shape]) -> None:
        self._mitsuba = _load_mitsuba()
        scene = {name: self._loaded(shape) for name, shape in shapes.items()}
        integrator = {"type": "path", "max_depth": MAX_DEPTH}
        whole = {"type": "scene", "integrator": integrator, **scene}
        # The optimiser merges equal lamps in a varying order: one rendering in twenty would differ.
        self._scene = self._mitsuba.load_dict(whole, optimize=False)

    @property
    def version(self) -> str:
        """Return name and version of the renderer."""
        return f"mitsuba {self._mitsuba.__version__} scalar_rgb"

    def look(self, camera: Pinhole, *, samples: int, seed: int) -> NDArray[np.float32]:
        """Return the radiance (height, width, 3) of red, green and blue that reaches each pixel."""
        picture = cancellable(
            lambda: self._mitsuba.render(self._scene, sensor=self._sensor(camera), spp=samples, seed=seed),
            self._scene.integrator().cancel,
        )
        return np.asarray(picture, dtype=np.float32)

    def sees(self, camera: Pinhole, point_mm: Vector) -> bool:
        """Whether nothing stands between the camera and a world point (3,)."""
        way_mm = point_mm - camera.position_mm
        distance_mm = float(np.linalg.norm(way_mm))
        origin, direction = camera.position_mm.tolist(), (way_mm / distance_mm).tolist()
        # Stop a millimetre short, else the surface with the point would hide it.
        ray = self._mitsuba.Ray3f(origin, direction, distance_mm - 1.0, 0.0, [])
        return not self._scene.ray_test(ray)

    def depths_mm(self, camera: Pinhole) -> Vector:
        """Return the depth at which each pixel's centre meets something (height, width); inf for nothing."""
        origin, rays = camera.position_mm.tolist(), camera.rays()
        lengths = np.linalg.norm(rays, axis=-1, keepdims=True)
        directions = (rays / lengths).reshape(-1, 3).tolist()
        ray = self._mitsuba.Ray3f
        met = [self._scene.ray_intersect_preliminary(ray(origin, way)).t for way in directions]
        depths: Vector = np.array(met).reshape(lengths.shape[:2]) / lengths[..., 0]
        return depths

    def _sensor(self, camera: Pinhole) -> Any:
        _, down, forward = camera.rotation
        position = camera.position_mm
        look_at = self._mitsuba.ScalarTransform4f().look_at(
            origin=position.tolist(), target=(position + forward).tolist(), up=(-down).tolist()
        )
        film = {
            "type": "hdrfilm",
            "width": camera.width_px,
            "height": camera.height_px,
            "pixel_format": "rgb",
            "rfilter": {"type": "box"},
        }
        return self._mitsuba.load_dict(
            {
                "type": "perspective",
                "fov_axis": "x",
                "fov": camera.horizontal_view_deg,
                "near_clip": 10.0,
                "far_clip": 20_000.0,
                "to_world": look_at,
                "film": film,
            }
        )

    def _loaded(self, shape: Shape) -> Shape:
        """Return the shape with the renderer's own objects in place of numpy arrays."""
        makers = {"to_world": self._mitsuba.ScalarTransform4f, "bitmap": self._mitsuba.Bitmap}
        return {
            key: makers[key](value)
            if isinstance(value, np.ndarray)
            else self._loaded(value)
            if isinstance(value, dict)
            else value
            for key, value in shape.items()
        }


def _load_mitsuba() -> Any:
    # It starts the threads that render. If one of our threads handles a signal, its import takes Ctrl-C for a missing
    # part.
    with uninterrupted(), held_back():
        try:
            mitsuba = importlib.import_module("mitsuba")
        except ImportError as error:
            raise RecordingError(
                'the renderer mitsuba must be installed to render a scene: pip install "bfsim[scenes]"'
            ) from error
        # The scalar variant needs no system LLVM and gives the same picture on every machine.
        mitsuba.set_variant("scalar_rgb")
    return mitsuba
