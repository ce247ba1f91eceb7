"""Ground truth of one stereo frame as plain JSON data: poses and sizes in mm, picture positions in pixels.

Each frame has one object: "cameras" and "lines", and each thing of the scene under its own name with its "kind".
Corners and centres are those of the ideal projection, even if they are hidden or outside the picture. The ends of field
lines and of the edges of boxes are cut to the picture and say whether they are visible.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bfsim.recording.scenes.objects import Ball, Box, Goal, Robot, Thing
from bfsim.recording.scenes.pinhole import Pinhole, Vector
from bfsim.recording.scenes.scene import Scene

Cameras = dict[str, Pinhole]

Sight = Callable[[Pinhole, Vector], bool]
"""Whether nothing stands between a camera and a world point."""

# The edges of a box seen from its front (-x), as indices of `Box.corners_mm`.
EDGES = {
    "bottom front": (0, 1), "bottom right": (1, 2), "bottom back": (2, 3), "bottom left": (3, 0),
    "top front": (4, 5), "top right": (5, 6), "top back": (6, 7), "top left": (7, 4),
    "front left": (0, 4), "front right": (1, 5), "back right": (2, 6), "back left": (3, 7),
}  # fmt: skip


def frame_truth(scene: Scene, cameras: Cameras, sight: Sight) -> dict[str, Any]:
    """Return where everything in a scene is, in the world and in the pictures of the "left" and "right" camera."""
    return {
        "cameras": {side: camera_truth(camera) for side, camera in cameras.items()},
        **{name: _thing_truth(thing, cameras, sight) for name, thing in scene.things.items()},
        "lines": [
            {"name": line.name, "width_mm": line.width_mm, **segment_truth(line.ends_mm, cameras, sight)}
            for line in scene.floor.lines
        ],
        "arcs": [asdict(arc) for arc in scene.floor.arcs],
    }


def _thing_truth(thing: Thing, cameras: Cameras, sight: Sight) -> dict[str, Any]:
    match thing:
        case Ball():
            return {"kind": "ball", **ball_truth(thing, cameras)}
        case Robot():
            return {"kind": "robot", **robot_truth(thing, cameras, sight)}
        case Goal():
            return {"kind": "goal", **goal_truth(thing, cameras)}
        case Box():
            return {"kind": "box", **box_truth(thing, cameras, sight)}


def camera_truth(camera: Pinhole) -> dict[str, Any]:
    """Return the position of a camera; the rows of its rotation are its right, down and forward in the world."""
    return {
        "position_mm": camera.position_mm.tolist(),
        "rotation": camera.rotation.tolist(),
        "focal_px": camera.focal_px,
        "centre_px": camera.centre_px.tolist(),
    }


def ball_truth(ball: Ball, cameras: Cameras) -> dict[str, Any]:
    """Return the ball in the world, and for each camera its position in camera axes and its exact outline."""
    views = {side: _outline(ball, camera) for side, camera in cameras.items()}
    disparity_px = views["left"]["centre_px"][0] - views["right"]["centre_px"][0]
    return {
        "centre_mm": ball.centre_mm.tolist(),
        "radius_mm": ball.radius_mm,
        "disparity_px": disparity_px,
        **views,
    }


def _outline(ball: Ball, camera: Pinhole) -> dict[str, Any]:
    """Return the image of a sphere: the section of its tangent cone with the image plane.

    With the centre c = (X, Y, Z) in the camera frame and the radius r it is an ellipse round
    f (X, Y) Z / (Z^2 - r^2). Its long axis points at the principal point; its half axes are
    f r sqrt(|c|^2 - r^2) / (Z^2 - r^2) and f r / sqrt(Z^2 - r^2).
    """
    inside_mm = camera.from_world(ball.centre_mm)
    depth_mm, square = inside_mm[2], inside_mm[2] ** 2 - ball.radius_mm**2
    long = ball.radius_mm * np.sqrt(inside_mm @ inside_mm - ball.radius_mm**2) / square
    middle_px = camera.centre_px + camera.focal_px * inside_mm[:2] * depth_mm / square
    return {
        "camera_mm": inside_mm.tolist(),
        "centre_px": camera.project(ball.centre_mm).tolist(),
        "outline_centre_px": middle_px.tolist(),
        "outline_half_axes_px": [
            float(camera.focal_px * long),
            float(camera.focal_px * ball.radius_mm / np.sqrt(square)),
        ],
    }


def robot_truth(robot: Robot, cameras: Cameras, sight: Sight) -> dict[str, Any]:
    """Return the other robot's pose and its mark: corners (four below, then the four above them) and edges."""
    corners_mm = robot.mark.corners_mm
    return {
        "position_mm": [robot.x_mm, robot.y_mm],
        "heading_deg": robot.heading_deg,
        "side_mm": robot.side_mm,
        "mark_corners_mm": corners_mm.tolist(),
        **{
            side: {"mark_corners_px": camera.project(corners_mm).tolist()} for side, camera in cameras.items()
        },
        "mark_edges": _edges(robot.mark, cameras, sight),
    }


def goal_truth(goal: Goal, cameras: Cameras) -> dict[str, Any]:
    """Return the corners of the goal's mouth: bottom left, bottom right, top right, top left.

    Their pixels are null for a camera that has some of them beside or behind it.
    """
    corners_mm = goal.mouth_mm
    return {
        "mouth_mm": corners_mm.tolist(),
        **{
            side: {"mouth_px": camera.project(corners_mm).tolist() if camera.faces(corners_mm) else None}
            for side, camera in cameras.items()
        },
    }


def box_truth(box: Box, cameras: Cameras, sight: Sight) -> dict[str, Any]:
    """Return where a box stands, and its edges."""
    return {
        "foot_mm": list(box.foot_mm),
        "size_mm": list(box.size_mm),
        "heading_deg": box.heading_deg,
        "edges": _edges(box, cameras, sight),
    }


def _edges(box: Box, cameras: Cameras, sight: Sight) -> dict[str, Any]:
    corners_mm = box.corners_mm
    return {name: segment_truth(corners_mm[list(ends)], cameras, sight) for name, ends in EDGES.items()}


def segment_truth(ends_mm: Vector, cameras: Cameras, sight: Sight) -> dict[str, Any]:
    """Return a world segment (2, 3), and for each camera the ends of its part in the picture, or null."""
    return {
        "ends_mm": ends_mm.tolist(),
        **{side: _segment_view(ends_mm, camera, sight) for side, camera in cameras.items()},
    }


def _segment_view(ends_mm: Vector, camera: Pinhole, sight: Sight) -> dict[str, Any] | None:
    held_mm = camera.clip(ends_mm)
    if held_mm is None:
        return None
    return {
        "ends_px": camera.project(held_mm).tolist(),
        "visible": [sight(camera, end_mm) for end_mm in held_mm],
    }


def disparity(depths_mm: Vector, cameras: Cameras) -> NDArray[np.float32]:
    """Return the disparity in px of each pixel of the left camera from its depth: 0 where there is nothing.

    It tells where the right picture would show the same point, whether or not something hides it there.
    """
    left, right = cameras["left"], cameras["right"]
    baseline_mm = float(np.linalg.norm(right.position_mm - left.position_mm))
    return (left.focal_px * baseline_mm / depths_mm).astype(np.float32)
