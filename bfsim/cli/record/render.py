"""The command `bfsim record render`: parse, call, print."""

from __future__ import annotations

from pathlib import Path
from textwrap import fill

import click

from bfsim import shipped
from bfsim.errors import shown
from bfsim.process.terminal import progress_bar

MOST_SAMPLES = 1_000_000
"""More than anybody waits for; mitsuba counts to 2**32 - 1, and hears no Ctrl-C while it renders a picture."""


class _Distances(click.ParamType[tuple[float, ...]]):
    name = "MM,MM"

    def convert(
        self, value: str, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, ...]:
        try:
            return tuple(float(part) for part in value.split(","))
        except ValueError:
            self.fail(f"distances must be like 250,300,350, not {shown(value)}", param, ctx)


_RENDER_HELP = f"""Render SCENE with exact ground truth to the recording OUTPUT.

SCENE is one or several scenes of bfsim.recording.scenes, FILE.py:NAME or PACKAGE:NAME, or a built-in one:

\b
{fill(", ".join(shipped.SCENES), 76, break_on_hyphens=False)}

Several scenes go to the folder OUTPUT, one recording each. Needs mitsuba: pip install "bfsim[scenes]".

\b
Examples:
  bfsim record render ball-with-seam ball.mcap
  bfsim record render box-distances box.mcap --distances 250,500
  bfsim record render soccer bent.mcap --distort -0.25 0.08 0 0 \\
      --turn-right 1 -1 0.5 --chessboards boards/
  bfsim record render my_scenes.py:night night.mcap
"""


@click.command(name="render", short_help="Render a scene with exact ground truth.", help=_RENDER_HELP)
@click.argument("name", metavar="SCENE")
@click.argument("output", type=click.Path(path_type=Path))
@click.option("--frames", metavar="N", type=click.IntRange(min=1), help="Render only the first N frames.")
@click.option(
    "--samples",
    metavar="N",
    type=click.IntRange(min=1, max=MOST_SAMPLES),
    help="Light paths per pixel.  [default: the scene's]",
)
@click.option(
    "--distances",
    type=_Distances(),
    metavar="MM,MM,...",
    help="Render a frame at each distance; only for scenes that are made for it.",
)
@click.option(
    "--geometry",
    type=float,
    nargs=4,
    metavar="FOCAL BASELINE HEIGHT TILT",
    help="Other cameras: focal length in px, baseline and height in mm, and how many degrees they look down.",
)
@click.option(
    "--distort",
    type=float,
    nargs=4,
    metavar="K1 K2 P1 P2",
    help="Put lenses in front of both cameras: two radial and two tangential terms, as in OpenCV.",
)
@click.option(
    "--turn-right",
    type=float,
    nargs=3,
    metavar="X Y Z",
    help="Turn the right camera, in degrees around its right, down and forward axes.",
)
@click.option(
    "--shift-right",
    type=float,
    nargs=3,
    metavar="X Y Z",
    help="Shift the right camera, in mm to its right, down and forward.",
)
@click.option(
    "--chessboards",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Also write chessboard pictures of these cameras, for `bfsim record calibrate`.",
)
@click.option("--force", is_flag=True, help="Overwrite OUTPUT if it exists.")
def render_command(
    name: str,
    output: Path,
    frames: int | None,
    samples: int | None,
    distances: tuple[float, ...] | None,
    geometry: tuple[float, float, float, float] | None,
    distort: tuple[float, float, float, float] | None,
    turn_right: tuple[float, float, float] | None,
    shift_right: tuple[float, float, float] | None,
    chessboards: Path | None,
    force: bool,
) -> None:
    """Render one scene, or several."""
    from bfsim.loading.scenes import load_scenes
    from bfsim.recording import StereoGeometry, scenes

    misfit = None
    if distort or turn_right or shift_right:
        zeros = (0.0, 0.0, 0.0)
        lens = scenes.Lens(*distort) if distort else scenes.Lens()
        misfit = scenes.Misfit(lens, turn_right or zeros, shift_right or zeros)
    with progress_bar("Rendering") as progress:
        paths = scenes.render(
            load_scenes(name),
            output,
            frames=frames,
            samples=samples,
            distances_mm=distances,
            geometry=StereoGeometry(*geometry) if geometry else None,
            misfit=misfit,
            chessboards=chessboards,
            force=force,
            progress=progress,
        )
    for path in paths:
        click.echo(f"{path}: {path.stat().st_size / 1e6:.1f} MB")
    if chessboards:
        click.echo(f"{chessboards}: chessboard pictures of the same cameras")
