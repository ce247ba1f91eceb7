"""The features of the firmware beside OpenCV's, on the pictures of recordings: edges, blobs and lines.

`python benchmarks/feature_quality.py [RECORDING]... [--frames N]` plays recordings (the built-in one without a name)
through the simulated board and reads edges, blobs and lines out of its memories. `benchmarks/quality/` says for each
feature what is compared with what. Needs OpenCV (`pip install -e ".[opencv]"`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType

import click
from rich.table import Table

from benchmarks.quality import blobs, edges, lines
from benchmarks.quality.seen import Seen, see_recording
from bfsim.errors import BfsimError
from bfsim.process.terminal import print_report
from bfsim.report.tables.table import new_table, stacked
from bfsim.shipped import RECORDING

FEATURES = edges, blobs, lines


def comparison(feature: ModuleType, recordings: Mapping[str, Sequence[Seen]]) -> Table:
    """Return a row of numbers for each recording."""
    table = new_table(feature.TITLE, "Recording", "pictures", *feature.COLUMNS)
    table.caption, table.caption_justify = feature.NOTE, "left"
    for name, seen in recordings.items():
        table.add_row(name, f"{len(seen)}", *feature.cells(seen))
    return table


@click.command()
@click.argument("recordings", nargs=-1, type=click.Path(path_type=Path))
@click.option(
    "--frames",
    metavar="N",
    type=click.IntRange(min=1),
    default=10,
    show_default=True,
    help="At most N of each.",
)
def main(recordings: tuple[Path, ...], frames: int) -> None:
    """Compare the features found in RECORDINGS, or in the built-in one, with OpenCV's."""
    try:
        seen = {path.stem: see_recording(path, frames) for path in recordings or (RECORDING,)}
    except BfsimError as error:
        raise click.ClickException(str(error)) from None
    print_report(stacked(*(comparison(feature, seen) for feature in FEATURES)))


if __name__ == "__main__":
    main()
