"""What the thesis does not say of the scenes of T Table 6.4, and what it is worth: lenses, lamps, noise, what else is in view.

`python -m benchmarks.robot.unknowns`: the firmware `thesis` on the scenes as they come with bfsim, and with one thing of
each changed that the text leaves open. Needs mitsuba.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import click
import numpy as np

from benchmarks.rectified.cameras import RealCameras
from benchmarks.robot.recordings import write_rectified
from benchmarks.table_6_4 import FRAME, ROWS, Times, times
from bfsim.process.terminal import print_report
from bfsim.recording import RecordingReader
from bfsim.recording.scenes import Scene
from bfsim.recording.scenes.lens import Lens, Misfit
from bfsim.recording.scenes.studio import record_scene
from bfsim.report.tables.table import new_table
from tinyphoon.scenes.soccer import LIGHT
from tinyphoon.scenes.thesis import BALL_BESIDE_GOAL, BALL_BESIDE_ROBOT, BALL_TOO_CLOSE
from tinyphoon.stages.colour_reduction import BLACK, SINGLE_COLOURS, colour_row
from tinyphoon.strategy.modes import THESIS_FIELD
from tinyphoon.tables import arctangent_table

HALF_THE_NOISE = 4  # times as many light paths
LENSES = Misfit(Lens(-0.25, 0.08), turn_deg=(1.0, -1.0, 0.5))
"""Those of `bfsim record render --help`: the thesis says that its pictures were rectified (T §5.2.5), and not by how much."""
HEADS = ("not black, %", *ROWS[:-1], FRAME)


@dataclass(frozen=True, slots=True)
class Variant:
    """A scene as it may have been."""

    title: str
    scene: Scene
    lenses: Misfit | None = None

    def record(self, folder: Path) -> Path:
        """Render it, and return the recording; what lenses bend has tables that rectify it."""
        rendered, rectified = folder / "rendered.mcap", folder / "rectified.mcap"
        record_scene(self.scene, rendered, misfit=self.lenses)
        if self.lenses is None:
            return rendered
        with RecordingReader(rendered) as reader:
            assert reader.geometry is not None
            cameras = RealCameras(reader.geometry.focal_px, self.lenses.lens, self.lenses.turn_deg)
            tables = cameras.tables(reader.height, reader.width)
        write_rectified(rendered, rectified, tables)
        return rectified


def without(scene: Scene, *things: str) -> Scene:
    """Return a scene without some things."""
    return replace(scene, things={name: each for name, each in scene.things.items() if name not in things})


def in_half_the_noise(scene: Scene) -> Scene:
    """Return a scene with less noise."""
    return replace(scene, samples=HALF_THE_NOISE * scene.samples)


DARK = replace(BALL_TOO_CLOSE, light=LIGHT)
VARIANTS = (
    Variant("Figure 6.7", BALL_BESIDE_GOAL),
    Variant("through lenses, rectified", BALL_BESIDE_GOAL, LENSES),
    Variant("half the noise", in_half_the_noise(BALL_BESIDE_GOAL)),
    Variant("Figure 6.10, top row", BALL_BESIDE_ROBOT),
    Variant("through lenses, rectified", BALL_BESIDE_ROBOT, LENSES),
    Variant("half the noise", in_half_the_noise(BALL_BESIDE_ROBOT)),
    Variant("no light from the window", replace(BALL_BESIDE_ROBOT, light=LIGHT)),
    Variant("Figure 6.13", BALL_TOO_CLOSE),
    Variant("through lenses, rectified", BALL_TOO_CLOSE, LENSES),
    Variant("half the noise", in_half_the_noise(BALL_TOO_CLOSE)),
    Variant("no goal in view", without(BALL_TOO_CLOSE, "goal")),
    Variant("no lamp above the ball, which is not too bright then", DARK),
    Variant("neither", without(DARK, "goal")),
)


def share_of_colours(recording: Path) -> float:
    """Return how many pixels of the first left picture are not black, in %: these are all that want a hue or are white."""
    with RecordingReader(recording) as reader:
        picture = next(iter(reader.frames())).left
    words = np.zeros((picture.shape[0], picture.shape[1] // 2), np.uint32)
    for line, found in zip(picture.copy(), words, strict=True):
        colour_row(line, arctangent_table(), SINGLE_COLOURS, found, *THESIS_FIELD.edges.colour_limits)
    return float((words != BLACK).mean() * 100)


def unknowns() -> Iterator[tuple[str, float, Times]]:
    """Yield each variant's title, how much of it is not black in %, and its times."""
    with tempfile.TemporaryDirectory() as folder:
        for each in VARIANTS:
            path = each.record(Path(folder))
            yield each.title, share_of_colours(path), times(path, "thesis")


def cells(share: float, found: Times) -> tuple[str, ...]:
    """Return what stands under `HEADS`."""
    return f"{share:.0f}", *(f"{found[row]:.1f}" for row in (*ROWS[:-1], FRAME))


@click.command(help=__doc__)
def main() -> None:
    """Print the table."""
    table = new_table("What the scenes leave open", "ms of core A", *HEADS)
    for title, share, found in unknowns():
        table.add_row(title, *cells(share, found))
    print_report(table)


if __name__ == "__main__":
    main()
