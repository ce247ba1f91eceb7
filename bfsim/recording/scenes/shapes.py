"""The shape that the renderer draws for each thing of a scene.

A shape is a dictionary in mitsuba's scene format with 4x4 numpy matrices in the place of its transforms:
building a scene needs no renderer.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from bfsim.recording.scenes.objects import Ball, Box, Colour, FieldLine, Lamp, placed

Shape = dict[str, Any]


def ball(thing: Ball, roughness: float) -> Shape:
    """Return a sphere."""
    return {
        "type": "sphere",
        "center": thing.centre_mm.tolist(),
        "radius": thing.radius_mm,
        "bsdf": _coat(thing.colour, roughness),
    }


def box(thing: Box, roughness: float) -> Shape:
    """Return a box."""
    return {"type": "cube", "to_world": thing.matrix, "bsdf": _coat(thing.colour, roughness)}


def floor(size_mm: tuple[float, float], colour: Colour, roughness: float) -> Shape:
    """Return the floor, its middle at the origin."""
    matrix = placed(np.zeros(3), np.array([size_mm[0] / 2, size_mm[1] / 2, 1.0]))
    return {"type": "rectangle", "to_world": matrix, "bsdf": _coat(colour, roughness)}


def line(thing: FieldLine, colour: Colour) -> Shape:
    """Return a matt stroke, half its width longer at both ends so that corners close."""
    start_mm, end_mm = thing.ends_mm
    along = end_mm - start_mm
    half_mm = np.array([(np.linalg.norm(along) + thing.width_mm) / 2, thing.width_mm / 2, 1.0])
    matrix = placed((start_mm + end_mm) / 2, half_mm, math.degrees(math.atan2(along[1], along[0])))
    return {"type": "rectangle", "to_world": matrix, "bsdf": _matt(colour)}


def lamp(thing: Lamp) -> Shape:
    """Return a panel of light."""
    facing_down = np.diag([1.0, -1.0, -1.0, 1.0])
    half_mm = np.array([thing.size_mm[0] / 2, thing.size_mm[1] / 2, 1.0])
    emitter = {"type": "area", "radiance": _rgb((thing.radiance,) * 3)}
    return {
        "type": "rectangle",
        "to_world": placed(np.array(thing.centre_mm), half_mm) @ facing_down,
        "emitter": emitter,
    }


def room(radiance: float) -> Shape:
    """Return the dim light that comes from everywhere, and that the camera sees behind all things."""
    return {"type": "constant", "radiance": _rgb((radiance,) * 3)}


def _coat(colour: Colour, roughness: float) -> Shape:
    """Return lacquer or plastic: a colour under a clear coat that reflects the lamps softly."""
    return {"type": "roughplastic", "diffuse_reflectance": _rgb(colour), "alpha": roughness}


def _matt(colour: Colour) -> Shape:
    return {"type": "diffuse", "reflectance": _rgb(colour)}


def _rgb(colour: Colour) -> Shape:
    return {"type": "rgb", "value": list(colour)}
