"""Ground truth of one stereo frame as plain JSON data: poses and sizes in mm, picture positions in pixels.

Corners and centres are those of the ideal projection, whether or not something stands before them or they are
outside the picture. The ends of field lines are cut to the picture and say if they are visible.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from bfsim.recording.scenes.objects import Ball, FieldLine, Goal, Robot
from bfsim.recording.scenes.pinhole import Pinhole, Vector

Sight = Callable[[Pinhole, Vector], bool]
"""Tells if nothing stands between a camera and a world point."""


def camera_truth(camera: Pinhole) -> dict[str, Any]:
    """Return where a camera is; the rows of its rotation are its right, down and forward in the world."""
    return {
        "position_mm": camera.position_mm.tolist(),
        "rotation": camera.rotation.tolist(),
        "focal_px": camera.focal_px,
        "centre_px": camera.centre_px.tolist(),
    }


def ball_truth(ball: Ball, cameras: dict[str, Pinhole]) -> dict[str, Any]:
    """Return the ball in the world, and for each camera its place before it and its exact outline."""
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


def robot_truth(robot: Robot, cameras: dict[str, Pinhole]) -> dict[str, Any]:
    """Return the other robot's pose and the corners of its mark: four below, then the four over them."""
    corners_mm = robot.mark.corners_mm
    return {
        "position_mm": [robot.x_mm, robot.y_mm],
        "heading_deg": robot.heading_deg,
        "side_mm": robot.side_mm,
        "mark_corners_mm": corners_mm.tolist(),
        **{
            side: {"mark_corners_px": camera.project(corners_mm).tolist()} for side, camera in cameras.items()
        },
    }


def goal_truth(goal: Goal, cameras: dict[str, Pinhole]) -> dict[str, Any]:
    """Return the corners of the goal's mouth: bottom left, bottom right, top right, top left."""
    corners_mm = goal.mouth_mm
    return {
        "mouth_mm": corners_mm.tolist(),
        **{side: {"mouth_px": camera.project(corners_mm).tolist()} for side, camera in cameras.items()},
    }


def lines_truth(
    lines: Iterable[FieldLine], cameras: dict[str, Pinhole], sight: Sight
) -> list[dict[str, Any]]:
    """Return each field line, and for each camera the ends of what the picture holds of it, or null."""
    return [
        {
            "name": line.name,
            "width_mm": line.width_mm,
            "ends_mm": line.ends_mm.tolist(),
            **{side: _line_view(line, camera, sight) for side, camera in cameras.items()},
        }
        for line in lines
    ]


def _line_view(line: FieldLine, camera: Pinhole, sight: Sight) -> dict[str, Any] | None:
    ends_mm = camera.clip(line.ends_mm)
    if ends_mm is None:
        return None
    return {
        "ends_px": camera.project(ends_mm).tolist(),
        "visible": [sight(camera, end_mm) for end_mm in ends_mm],
    }
