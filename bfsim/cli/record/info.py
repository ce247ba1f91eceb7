"""The command `bfsim record info`: parse, call, print."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import click

from bfsim.cli.options.json_file import json_option, require_json_place, tell
from bfsim.cli.record.recorded import info_table
from bfsim.errors import ConfigError
from bfsim.process.terminal import print_report, progress_bar

SCHEMA = "bfsim.recording/1"


@click.command(name="info", short_help="Describe a recording.")
@click.argument("path", metavar="RECORDING", type=click.Path(path_type=Path))
@json_option("the description")
@click.option(
    "--plot",
    type=click.Path(path_type=Path),
    help="Write the plot of the calibration's residuals to this PNG file.",
)
def info_command(path: Path, json_path: Path | None, plot: Path | None) -> None:
    """Describe RECORDING. This reads all of it, so an answer also means that the file is intact.

    \b
    Examples:
      bfsim record info run.mcap
      bfsim record info run.mcap --plot residuals.png
      bfsim record info run.mcap --json
    """
    from bfsim.files.save import require_place, write_bytes
    from bfsim.recording import RecordingReader
    from bfsim.recording.info import describe_recording

    if plot:
        if plot.suffix.lower() != ".png":
            raise ConfigError(f"--plot must be a file *.png, not {plot}")
        require_place(plot)
    require_json_place(json_path, (path, plot))
    with RecordingReader(path) as reader, progress_bar("Reading") as progress:
        info = describe_recording(reader, progress)
        if plot:
            write_bytes(plot, [reader.residual_plot()])
    tell(
        json_path,
        lambda: [json.dumps({"schema": SCHEMA, **asdict(info)}, default=str, indent=2), "\n"],
        lambda: print_report(info_table(info)),
    )
