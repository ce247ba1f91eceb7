"""The command `bfsim record calibrate`: parse, call, print."""

from __future__ import annotations

from pathlib import Path

import click

from bfsim.cli.options.sizes import Size
from bfsim.cli.record.recorded import view_text, views_text
from bfsim.process.terminal import progress_bar


@click.command(name="calibrate", short_help="Make rectification tables and geometry from chessboards.")
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
@click.option("--height", type=float, metavar="MM", help="Height of the cameras above the floor in mm.")
@click.option("--tilt", type=float, metavar="DEG", help="How far the cameras look down, in degrees.")
@click.option("--fisheye", is_flag=True, help="The lenses are fisheyes: 100 degrees and more across.")
@click.option("--mono", is_flag=True, help="CHESSBOARDS holds pictures of the one camera of RECORDING.")
@click.option(
    "--resize", is_flag=True, help="Scale the chessboards, as `record import --resize` scaled RECORDING."
)
@click.option(
    "--bits",
    type=click.IntRange(8, 16),
    metavar="N",
    help="As for `record import`, if the chessboards have pixels of 16 bits.",
)
@click.option(
    "--output", type=click.Path(path_type=Path), help="Write this file and leave RECORDING unchanged."
)
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
    bits: int | None,
    output: Path | None,
) -> None:
    """Write rectification tables and the geometry into RECORDING, made from chessboard pictures of its cameras.

    The folder CHESSBOARDS has pictures, or folders of them, whose names say left and right; left_03 and right_03 were
    taken at the same time. Pictures without a board are skipped, and pairs that do not fit the rest are left out; both are
    listed. Focal length and baseline are measured; you give height and tilt, here or at the import. Needs OpenCV:
    pip install "bfsim[opencv]".

    \b
    Examples:
      bfsim record calibrate boards/ run.mcap
      bfsim record calibrate boards/ run.mcap --corners 8x5 --square 25 --height 120 --tilt 10
      bfsim record calibrate boards/ phone.mcap --mono
    """
    from bfsim.recording import RecordingReader
    from bfsim.recording.calibrating.calibrated_recording import calibrate_recording

    with progress_bar("Looking for boards", with_time=False) as progress:
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
            bits=bits,
            progress=progress,
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
    by = (
        f"; the baseline is by squares of {square:g} mm, as `--square` says"
        if len(report.cameras) > 1
        else ""
    )
    click.echo(f"Geometry: {geometry}{by}")
    for view in report.outliers:
        click.echo(f"Left out: {view_text(view)}: does not fit the others")
    for each in report.skipped:
        click.echo(f"Skipped: {each.name}: {each.reason}")
