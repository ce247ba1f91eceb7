"""The built-in recording: a robot drives at the ball; before it stand another robot and the goal.

`python -m bfsim.recording.scenes.soccer OUT.mcap` renders it again.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import click
import numpy as np
from PIL import Image

from bfsim.errors import RecordingError
from bfsim.recording.frames import UyvyImage
from bfsim.recording.planes import YuvPlanes
from bfsim.recording.scenes import shapes, truth
from bfsim.recording.scenes import soccer_data as scene
from bfsim.recording.scenes.pinhole import HEIGHT_PX, WIDTH_PX, Pinhole
from bfsim.recording.scenes.renderer import Renderer
from bfsim.recording.scenes.sensor import expose
from bfsim.recording.writer import RecordingWriter

DESCRIPTION = (
    "Robot soccer: a Tinyphoon robot drives at the ball (yellow, 6 cm) in a slight left turn; before it "
    "another robot (red mark) and the goal (blue). Rendered by {renderer}, {samples} samples a pixel, seed "
    "{seed}. Both pictures of a frame are rendered at the pose of the left time stamp, so that each pair is "
    "exact. Ground truth: lengths in mm, x towards the goal, y left, z up, origin on the floor in the middle "
    "of the field; pixels as array indices, (0, 0) the centre of the first."
)


def soccer_shapes() -> dict[str, shapes.Shape]:
    """Return everything that the cameras can see, by name."""
    boxes = {
        **{f"goal_{name}": panel for name, panel in scene.GOAL.panels.items()},
        **{f"wall_{name}": wall for name, wall in scene.WALLS.items()},
        "robot_body": scene.ROBOT.body,
        "robot_mark": scene.ROBOT.mark,
    }
    return {
        "floor": shapes.floor(scene.FLOOR_MM, scene.BLACK, scene.FLOOR_ROUGHNESS),
        "ball": shapes.ball(scene.BALL, scene.OBJECT_ROUGHNESS),
        **{name: shapes.box(box, scene.OBJECT_ROUGHNESS) for name, box in boxes.items()},
        **{f"line_{index}": shapes.line(line, scene.WHITE) for index, line in enumerate(scene.LINES)},
        **{f"lamp_{index}": shapes.lamp(lamp) for index, lamp in enumerate(scene.LAMPS)},
        "room": shapes.room(scene.ROOM_RADIANCE),
    }


def soccer_truth(cameras: dict[str, Pinhole], renderer: Renderer) -> dict[str, Any]:
    """Return what is where, in the world and in both pictures."""
    return {
        "cameras": {side: truth.camera_truth(camera) for side, camera in cameras.items()},
        "ball": truth.ball_truth(scene.BALL, cameras),
        "robot": truth.robot_truth(scene.ROBOT, cameras),
        "goal": truth.goal_truth(scene.GOAL, cameras),
        "lines": truth.lines_truth(scene.LINES, cameras, renderer.sees),
    }


def record(path: Path, renderer: Renderer, frames: Iterable[int], *, samples: int) -> None:
    """Render the numbered frames of the drive and write them as a recording."""
    description = DESCRIPTION.format(renderer=renderer.version, samples=samples, seed=scene.SEED)
    with RecordingWriter(
        path, width=WIDTH_PX, height=HEIGHT_PX, geometry=scene.GEOMETRY, description=description
    ) as recording:
        for frame in frames:
            left_ns = frame * scene.FRAME_PERIOD_NS
            cameras = scene.DRIVE.cameras(left_ns / 1e9, scene.GEOMETRY)
            left, right = (
                _photograph(renderer, camera, samples=samples, seed=scene.SEED + 2 * frame + eye)
                for eye, camera in enumerate(cameras.values())
            )
            recording.add(
                left, right, left_ns, left_ns + scene.RIGHT_PHASE_NS, soccer_truth(cameras, renderer)
            )


def _photograph(renderer: Renderer, camera: Pinhole, *, samples: int, seed: int) -> UyvyImage:
    radiance = renderer.look(camera, samples=samples, seed=seed)
    picture = expose(radiance, np.random.default_rng(seed))
    return YuvPlanes.from_image(Image.fromarray(picture)).to_uyvy()


@click.command()
@click.argument("path", metavar="OUT.mcap", type=click.Path(path_type=Path))
@click.option("--frames", default=scene.FRAMES, show_default=True, help="Stereo frames to render.")
@click.option("--spp", default=scene.SAMPLES, show_default=True, help="Samples a pixel.")
def main(path: Path, frames: int, spp: int) -> None:
    """Render the soccer scene to OUT.mcap."""
    try:
        renderer = Renderer(soccer_shapes())
        with click.progressbar(range(frames), label="Rendering", file=sys.stderr) as numbers:
            record(path, renderer, numbers, samples=spp)
    except RecordingError as error:
        click.echo(f"error: {error}", err=True)
        sys.exit(2)


if __name__ == "__main__":
    main()
