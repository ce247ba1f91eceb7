"""The shape that the renderer draws for each thing of a scene.

A shape is a dictionary in mitsuba's scene format, with 4x4 numpy matrices in place of its transforms, so building a
scene needs no renderer.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from bfsim.recording.scenes.objects import (
    Ball,
    Box,
    Colour,
    FieldLine,
    Goal,
    Lamp,
    Robot,
    Thing,
    placed,
)
from bfsim.recording.scenes.scene import Floor, Scene

Shape = dict[str, Any]

# The seam of a tennis ball on the unit sphere: a cos t + b cos 3t, a sin t - b sin 3t, 2 sqrt(ab) sin 2t with a + b =
# 1. [assumed: the shape that looks right; width as a part of the radius]
_SEAM_A = 0.75
_SEAM_HALF_WIDTH = 0.06
_SEAM_POINTS = 720
_SEAM_TEXTURE = (128, 256)  # rows from pole to pole, columns round the axis


def scene_shapes(scene: Scene) -> dict[str, Shape]:
    """Return everything that the cameras of a scene can see, by name."""
    floor = scene.floor
    strokes = [*floor.lines, *(stroke for arc in floor.arcs for stroke in arc.strokes)]
    things = [_thing(name, thing, scene.roughness) for name, thing in scene.things.items()]
    return {
        "floor": _floor(floor),
        **{name: shape for shapes in things for name, shape in shapes.items()},
        **{f"line_{index}": _line(stroke, floor.paint) for index, stroke in enumerate(strokes)},
        **{f"lamp_{index}": _lamp(lamp) for index, lamp in enumerate(scene.light.lamps)},
        "room": _room(scene.light.room_radiance),
    }


def _thing(name: str, thing: Thing, roughness: float) -> dict[str, Shape]:
    match thing:
        case Ball():
            return {name: _ball(thing, roughness)}
        case Box():
            return {name: _box(thing, roughness)}
        case Robot():
            parts = {"body": thing.body, "mark": thing.mark}
        case Goal():
            parts = thing.panels
    return {f"{name}_{part}": _box(box, roughness) for part, box in parts.items()}


def _ball(thing: Ball, roughness: float) -> Shape:
    """Return a sphere."""
    if thing.seam_colour is None:
        coat = _coat(thing.colour, roughness)
    else:
        coat = {
            "type": "roughplastic",
            "diffuse_reflectance": _seam(thing, thing.seam_colour),
            "alpha": roughness,
        }
    return {"type": "sphere", "center": thing.centre_mm.tolist(), "radius": thing.radius_mm, "bsdf": coat}


def _seam(thing: Ball, colour: Colour) -> Shape:
    """Return the texture of a ball with a seam: columns are angles round z, rows are angles from the upper pole."""
    heights, widths = _SEAM_TEXTURE
    polar = ((np.arange(heights) + 0.5) / heights * math.pi)[:, None]
    azimuth = ((np.arange(widths) + 0.5) / widths * 2 * math.pi)[None, :] - math.radians(thing.seam_turn_deg)
    directions = np.stack(
        np.broadcast_arrays(np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)),
        axis=-1,
    )
    t, b = np.linspace(0, 2 * math.pi, _SEAM_POINTS), 1 - _SEAM_A
    seam = np.stack(
        [
            _SEAM_A * np.cos(t) + b * np.cos(3 * t),
            _SEAM_A * np.sin(t) - b * np.sin(3 * t),
            2 * math.sqrt(_SEAM_A * b) * np.sin(2 * t),
        ]
    )
    on_seam = (directions @ seam).max(axis=-1) > math.cos(_SEAM_HALF_WIDTH)
    texels = np.where(on_seam[..., None], colour, thing.colour).astype(np.float32)
    return {"type": "bitmap", "bitmap": texels, "raw": True}


def _box(thing: Box, roughness: float) -> Shape:
    """Return a box."""
    return {"type": "cube", "to_world": thing.matrix, "bsdf": _coat(thing.colour, roughness)}


def _floor(floor: Floor) -> Shape:
    """Return the floor without its paint."""
    matrix = placed(np.zeros(3), np.array([floor.size_mm[0] / 2, floor.size_mm[1] / 2, 1.0]))
    return {"type": "rectangle", "to_world": matrix, "bsdf": _coat(floor.colour, floor.roughness)}


def _line(thing: FieldLine, colour: Colour) -> Shape:
    """Return a matt stroke, extended by half its width at both ends so that corners close."""
    start_mm, end_mm = thing.ends_mm
    along = end_mm - start_mm
    half_mm = np.array([(np.linalg.norm(along) + thing.width_mm) / 2, thing.width_mm / 2, 1.0])
    matrix = placed((start_mm + end_mm) / 2, half_mm, math.degrees(math.atan2(along[1], along[0])))
    return {"type": "rectangle", "to_world": matrix, "bsdf": _matt(colour)}


def _lamp(thing: Lamp) -> Shape:
    """Return a panel that shines."""
    facing_down = np.diag([1.0, -1.0, -1.0, 1.0])
    half_mm = np.array([thing.size_mm[0] / 2, thing.size_mm[1] / 2, 1.0])
    emitter = {"type": "area", "radiance": _rgb((thing.radiance,) * 3)}
    return {
        "type": "rectangle",
        "to_world": placed(np.array(thing.centre_mm), half_mm) @ facing_down,
        "emitter": emitter,
    }


def _room(radiance: float) -> Shape:
    """Return the dim light that comes from everywhere, which the camera sees behind all things."""
    return {"type": "constant", "radiance": _rgb((radiance,) * 3)}


def _coat(colour: Colour, roughness: float) -> Shape:
    """Return lacquer or plastic: a colour under a clear coat that reflects the lamps softly."""
    return {"type": "roughplastic", "diffuse_reflectance": _rgb(colour), "alpha": roughness}


def _matt(colour: Colour) -> Shape:
    return {"type": "diffuse", "reflectance": _rgb(colour)}


def _rgb(colour: Colour) -> Shape:
    return {"type": "rgb", "value": list(colour)}
