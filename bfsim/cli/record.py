"""The commands `bfsim record import`, `info`, `render` and `calibrate`: parse, call, print."""

from __future__ import annotations

import json
from dataclasses import asdict
from itertools import groupby
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING

import click

from bfsim import shipped
from bfsim.cli.options.json_file import json_option, require_json_place, tell
from bfsim.cli.options.sizes import Size
from bfsim.cli.recorded import info_table, view_text, views_text
from bfsim.errors import RecordingError, shown
from bfsim.terminal import print_report, progress_bar

if TYPE_CHECKING:
    from bfsim.recording.sources import SourceFormat

SOURCE_FORMATS = ("images", "uyvy", "i420", "yuyv", "y4m", "video", "rosbag")
"""Those of bfsim.recording, which takes its time to import."""

_SKIPPED_LISTED = 10


class _Distances(click.ParamType[tuple[float, ...]]):
    name = "MM,MM"

    def convert(
        self, value: str, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, ...]:
        try:
            return tuple(float(part) for part in value.split(","))
        except ValueError:
            self.fail(f"distances must be like 250,300,350, not {shown(value)}", param, ctx)


@click.group(name="record")
def record() -> None:
    """Make recordings of stereo frames, and look at them."""


@record.command(name="import", short_help="Make a recording from pictures.")
@click.argument("output", type=click.Path(path_type=Path))
@click.argument("sources", nargs=-1, required=True, metavar="SOURCE [SOURCE2]")
@click.option(
    "--side-by-side", is_flag=True, help="Each picture of SOURCE is the left and the right camera's."
)
@click.option("--mono", is_flag=True, help="The one camera of SOURCE feeds both sides.")
@click.option(
    "--format",
    type=click.Choice(SOURCE_FORMATS),
    help="What the sources are, if names do not tell.",
)
@click.option(
    "--size", type=Size(), metavar="WxH", help="Size of the frames in raw UYVY, YUYV and I420 files."
)
@click.option(
    "--resize",
    type=Size(),
    metavar="WxH",
    help="Scale every picture, by a triangle filter; what sticks out of the aspect ratio is cut off.",
)
@click.option("--crop", type=Size(), metavar="WxH", help="Keep the middle of every picture, unscaled.")
@click.option("--fps", type=float, help="Frames per second.  [default: the source's own, or 30]")
@click.option(
    "--topics",
    nargs=2,
    metavar="LEFT RIGHT",
    help="Image topics of a bag.  [default: the two whose names differ by left and right]",
)
@click.option(
    "--slop",
    type=click.FloatRange(min=0),
    metavar="MS",
    help="How far the time stamps of two pictures of a bag may be apart.  [default: half a frame]",
)
@click.option(
    "--geometry",
    type=float,
    nargs=4,
    metavar="FOCAL BASELINE HEIGHT TILT",
    help="Focal length in px of the recorded size, baseline (0 for one camera) and height over the floor in mm, degrees "
    "the cameras look down.",
)
@click.option(
    "--rectification",
    nargs=2,
    metavar="LEFT RIGHT",
    help="Two .npy files of shape (2, height, width): for each pixel its source row and column, -1 for none.",
)
@click.option("--description", default="", help="Free text to keep with the recording.")
@click.option("--force", is_flag=True, help="Overwrite OUTPUT if it exists.")
def import_command(
    output: Path,
    sources: tuple[str, ...],
    side_by_side: bool,
    mono: bool,
    format: SourceFormat | None,
    size: tuple[int, int] | None,
    resize: tuple[int, int] | None,
    crop: tuple[int, int] | None,
    fps: float | None,
    topics: tuple[str, str] | None,
    slop: float | None,
    geometry: tuple[float, float, float, float] | None,
    rectification: tuple[str, str] | None,
    description: str,
    force: bool,
) -> None:
    """Make the recording OUTPUT from pictures.

    A SOURCE is a folder of images, a quoted pattern such as "seq/left_*.png", one image, a raw file
    (.uyvy, .yuyv, .yuv or .i420), a .y4m file or a video. Two sources are the left and the right camera. A bag of ROS (.bag of
    ROS 1, .mcap, .db3 or the folder of ROS 2) is one source with both: pictures are paired by their time stamps, and
    camera_info becomes geometry and rectification. Needs rosbags: pip install "bfsim[ros]".
    Images that cannot be read, those without a picture of the other camera by their names (left_07 goes with
    right_07), and other files in a folder are skipped and listed.

    \b
    Examples:
      bfsim record import run.mcap left/ right/ --fps 25
      bfsim record import run.mcap frames/ --side-by-side
      bfsim record import run.mcap left/ right/ --geometry 386 30.47 120 10
      bfsim record import run.mcap left.uyvy right.uyvy --size 320x240
      bfsim record import run.mcap drive.bag --topics /left/image_raw /right/image_raw
      bfsim record import run.mcap phone.mp4 --mono --resize 320x240
      bfsim record import run.mcap "match/*.jpg" --mono --resize 320x240 --geometry 260 0 480 12
    """
    from bfsim.recording import StereoGeometry
    from bfsim.recording.importer import import_recording, load_rectification

    with progress_bar("Importing") as progress:
        summary = import_recording(
            sources,
            output,
            format=format,
            size=size,
            resize=resize,
            crop=crop,
            side_by_side=side_by_side,
            mono=mono,
            fps=fps,
            topics=topics,
            slop_s=None if slop is None else slop / 1000,
            geometry=StereoGeometry(*geometry) if geometry else None,
            rectification=load_rectification(*rectification) if rectification else None,
            description=description,
            force=force,
            progress=progress,
        )
    frames = f"{'mono' if mono else 'stereo'} frame{'s' if summary.frame_count != 1 else ''}"
    click.echo(
        f"{summary.path}: {summary.frame_count} {frames} of {summary.width}x{summary.height} "
        f"at {float(summary.fps):g} per second, {summary.size_bytes / 1e6:.1f} MB"
    )
    if (resize or crop) and set(summary.source_sizes) != {(summary.width, summary.height)}:
        sizes = ", ".join(f"{width}x{height}" for width, height in summary.source_sizes)
        click.echo(f"{'Scaled by a triangle filter, and cut to shape,' if resize else 'Cut'} from {sizes}")
    for note in summary.notes:
        click.echo(note)
    for reason, found in groupby(summary.skipped, key=lambda each: each.reason):
        skipped = [each.name for each in found]
        more = f" and {len(skipped) - _SKIPPED_LISTED} more" if len(skipped) > _SKIPPED_LISTED else ""
        click.echo(f"Skipped: {', '.join(skipped[:_SKIPPED_LISTED])}{more}: {reason}")


@record.command(name="info", short_help="Say what is in a recording.")
@click.argument("path", metavar="RECORDING", type=click.Path(path_type=Path))
@json_option("what is in it")
@click.option(
    "--plot",
    type=click.Path(path_type=Path),
    help="Write the plot of the calibration's residuals to this PNG file.",
)
def info_command(path: Path, json_path: Path | None, plot: Path | None) -> None:
    """Describe RECORDING. Reads all of it, so an answer also says that it is whole.

    \b
    Examples:
      bfsim record info run.mcap
      bfsim record info run.mcap --plot residuals.png
      bfsim record info run.mcap --json
    """
    from bfsim.recording import RecordingReader
    from bfsim.recording.info import describe_recording

    require_json_place(json_path, (path, plot))
    with RecordingReader(path) as reader, progress_bar("Reading") as progress:
        info = describe_recording(reader, progress)
        if plot:
            _write(plot, reader.residual_plot())
    tell(
        json_path,
        lambda: [json.dumps(asdict(info), default=str, indent=2), "\n"],
        lambda: print_report(info_table(info)),
    )


@record.command(name="calibrate", short_help="Make rectification tables and geometry from chessboards.")
@click.argument("chessboards", metavar="CHESSBOARDS", type=click.Path(path_type=Path))
@click.argument("path", metavar="RECORDING", type=click.Path(path_type=Path))
@click.option(
    "--corners",
    type=Size(),
    metavar="WxH",
    default="9x6",
    show_default=True,
    help="Inner corners of the chessboard, across and down.",
)
@click.option("--square", type=float, default=20.0, show_default=True, help="Side of its squares in mm.")
@click.option("--height", type=float, metavar="MM", help="Height of the cameras over the floor in mm.")
@click.option("--tilt", type=float, metavar="DEG", help="How far the cameras look down, in degrees.")
@click.option("--fisheye", is_flag=True, help="The lenses are fisheyes: 100 degrees and more across.")
@click.option("--mono", is_flag=True, help="CHESSBOARDS holds pictures of the one camera of RECORDING.")
@click.option(
    "--resize", is_flag=True, help="Scale the chessboards, as `record import --resize` scaled RECORDING."
)
@click.option("--output", type=click.Path(path_type=Path), help="Write this file and leave RECORDING alone.")
def calibrate_command(
    chessboards: Path,
    path: Path,
    corners: tuple[int, int],
    square: float,
    height: float | None,
    tilt: float | None,
    fisheye: bool,
    mono: bool,
    resize: bool,
    output: Path | None,
) -> None:
    """Write rectification tables and the geometry into RECORDING, made from chessboard pictures of its cameras.

    The folder CHESSBOARDS holds pictures left* and right*, or folders left and right; left_03 and right_03 were taken
    at once. Pictures without a board are skipped, and what does not fit the rest is left out; both are listed. Focal
    length and baseline are measured; height and tilt must be given, here or at the import. Needs OpenCV:
    pip install "bfsim[opencv]".

    \b
    Examples:
      bfsim record calibrate boards/ run.mcap
      bfsim record calibrate boards/ run.mcap --corners 8x5 --square 25 --height 120 --tilt 10
      bfsim record calibrate boards/ phone.mcap --mono
    """
    from bfsim.recording import RecordingReader
    from bfsim.recording.calibration import calibrate_recording

    found = calibrate_recording(
        chessboards,
        path,
        output,
        corners=corners,
        square_mm=square,
        height_mm=height,
        tilt_deg=tilt,
        lens="fisheye" if fisheye else "pinhole",
        mono=mono,
        resize=resize,
    )
    with RecordingReader(output or path) as reader:
        geometry = reader.geometry
    report = found.report
    click.echo(f"{output or path}: rectification tables from {views_text(report)}")
    click.echo(
        f"Reprojection error: {report.reprojection_px:.3f} px RMS; picture by picture: `bfsim record info`, --plot FILE"
    )
    if len(report.cameras) > 1:
        click.echo(
            f"Vertical misalignment: {report.vertical_rms_px:.3f} px RMS, {report.vertical_worst_px:.3f} px at worst "
            f"(before: {report.vertical_before_px:.3f} px RMS)"
        )
    click.echo(f"Geometry: {geometry}")
    for view in report.outliers:
        click.echo(f"Left out: {view_text(view)}: does not fit the others")
    for each in report.skipped:
        click.echo(f"Skipped: {each.name}: {each.reason}")


_RENDER_HELP = f"""Render SCENE with exact ground truth to the recording OUTPUT.

SCENE is one scene or several of bfsim.recording.scenes, by FILE.py:NAME or PACKAGE:NAME, or built in:

\b
{fill(", ".join(shipped.SCENES), 76, break_on_hyphens=False)}

Several scenes go to the folder OUTPUT, each to a recording of its name. Needs mitsuba: pip install "bfsim[scenes]".

\b
Examples:
  bfsim record render ball-with-seam ball.mcap
  bfsim record render box-distances box.mcap --distances 250,500
  bfsim record render soccer bent.mcap --distort -0.25 0.08 0 0 \\
      --turn-right 1 -1 0.5 --chessboards boards/
  bfsim record render my_scenes.py:night night.mcap
"""


@record.command(name="render", short_help="Render a scene with exact ground truth.", help=_RENDER_HELP)
@click.argument("name", metavar="SCENE")
@click.argument("output", type=click.Path(path_type=Path))
@click.option("--frames", type=click.IntRange(min=1), help="Render only so many frames.")
@click.option("--samples", type=click.IntRange(min=1), help="Light paths a pixel.  [default: the scene's]")
@click.option(
    "--distances",
    type=_Distances(),
    metavar="MM,MM,...",
    help="A frame for each, of a scene that is made for distances.",
)
@click.option(
    "--geometry",
    type=float,
    nargs=4,
    metavar="FOCAL BASELINE HEIGHT TILT",
    help="Other cameras: focal length in px, baseline and height in mm, degrees they look down.",
)
@click.option(
    "--distort",
    type=float,
    nargs=4,
    metavar="K1 K2 P1 P2",
    help="Put lenses before both cameras: two radial and two tangential terms, as OpenCV counts them.",
)
@click.option(
    "--turn-right",
    type=float,
    nargs=3,
    metavar="X Y Z",
    help="Turn the right camera, degrees round its right, down and forward.",
)
@click.option(
    "--shift-right",
    type=float,
    nargs=3,
    metavar="X Y Z",
    help="Shift the right camera, mm to its right, down and forward.",
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
    from bfsim.recording import StereoGeometry, scenes
    from bfsim.scenery import load_scenes

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


def _write(path: Path, data: bytes) -> None:
    try:
        path.write_bytes(data)
    except OSError as error:
        raise RecordingError(f"{path}: file must be writable: {error.strerror}") from None
