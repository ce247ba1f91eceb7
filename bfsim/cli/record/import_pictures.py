"""The command `bfsim record import`: parse, call, print."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from bfsim.cli.options.sizes import Size
from bfsim.cli.record.imported import fitted_text, skipped_texts
from bfsim.process.terminal import progress_bar

if TYPE_CHECKING:
    from bfsim.recording.importing.sources import SourceFormat

SOURCE_FORMATS = (
    "images", "uyvy", "i420", "yuyv", "nv12", "grey", "bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8",
    "y4m", "video", "rosbag",
)  # fmt: skip
"""Choices from bfsim.recording, which takes long to import."""


@click.command(name="import", short_help="Make a recording from pictures.")
@click.argument("output", type=click.Path(path_type=Path))
@click.argument("sources", nargs=-1, required=True, metavar="SOURCE [SOURCE2]")
@click.option(
    "--side-by-side",
    is_flag=True,
    help="Each picture of SOURCE shows the left and the right camera side by side.",
)
@click.option("--mono", is_flag=True, help="SOURCE is one camera, which feeds both sides.")
@click.option(
    "--format",
    type=click.Choice(SOURCE_FORMATS),
    help="Format of the sources, if their names do not tell.",
)
@click.option("--size", type=Size(), metavar="WxH", help="Size of the frames in raw files.")
@click.option(
    "--bits",
    type=click.IntRange(8, 16),
    metavar="N",
    help="Pixels have 16 bits and the camera uses N of them, of which the upper 8 are taken. For grey images, and for grey and "
    "Bayer frames, raw or in a bag.",
)
@click.option(
    "--resize",
    type=Size(),
    metavar="WxH",
    help="Scale every picture with a triangle filter, and cut off what exceeds the aspect ratio.",
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
    help="How far apart the time stamps of a pair of a bag may be.  [default: half a frame]",
)
@click.option(
    "--geometry",
    type=float,
    nargs=4,
    metavar="FOCAL BASELINE HEIGHT TILT",
    help="Focal length in px of the recorded size, baseline (0 for one camera) and height above the floor in mm, and how many "
    "degrees the cameras look down.",
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
    bits: int | None,
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

    A SOURCE is a folder of images, a quoted pattern such as "seq/left_*.png", one image, a raw file (.uyvy, .yuyv,
    .i420 or .yuv, .nv12, .grey; others by --format), a .y4m file or a video. Two sources are the left and the right camera.
    A ROS bag (.bag of ROS 1; .mcap, .db3 or the folder of ROS 2) is one source with both cameras: pictures are paired by
    their time stamps, and camera_info becomes geometry and rectification. Needs rosbags: pip install "bfsim[ros]".

    Images are paired by their names (left_07 with right_07). Images that cannot be read, images without a partner, and
    other files in a folder are skipped and listed.

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
    from bfsim.recording.importing.importer import import_recording
    from bfsim.recording.importing.rectification_files import load_rectification

    with progress_bar("Importing") as progress:
        summary = import_recording(
            sources,
            output,
            format=format,
            size=size,
            bits=bits,
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
        click.echo(fitted_text(summary, is_scaled=resize is not None))
    for note in summary.notes:
        click.echo(note)
    for line in skipped_texts(summary.skipped):
        click.echo(line)
