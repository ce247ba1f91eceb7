"""The commands `bfsim record import`, `info`, `calibrate` and `render`."""

from __future__ import annotations

import click

from bfsim.cli.record.calibrate import calibrate_command
from bfsim.cli.record.import_pictures import import_command
from bfsim.cli.record.info import info_command
from bfsim.cli.record.render import render_command


@click.group(name="record")
def record() -> None:
    """Make recordings of stereo frames, and look at them."""


for command in (import_command, info_command, calibrate_command, render_command):
    record.add_command(command)
