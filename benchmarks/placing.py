"""What `bfsim place` finds: from each shipped LDF, the frame before and after it, and how well the gain was predicted.

`python benchmarks/placing.py [RECORDING] [--frames N]` prints one table. Where its numbers stand in docs/how-to/place.md it
ran on the built-in recording, and on three pictures of 640x480 from a RoboCup field.
"""

from __future__ import annotations

from pathlib import Path

import click
from rich.table import Table

from bfsim.errors import BfsimError
from bfsim.placing.placed import Placed
from bfsim.placing.search import place
from bfsim.process.terminal import print_report, progress_bar
from bfsim.report.tables.table import new_table, percent
from bfsim.run import simulate

PLACEMENTS = ("sdram", "l2", "cache", "thesis")
"""Files of ldf/."""


def place_all(recording: Path | None, frames: int | None) -> dict[str, Placed]:
    """Find the best placement from every LDF behind one progress bar."""
    found = {}
    with progress_bar("Placing") as progress:
        for number, name in enumerate(PLACEMENTS):
            found[name] = place(
                recording,
                firmware="tinyphoon",
                board="cm-bf561",
                ldf=Path(name),
                profile="vdsp-O2",
                frames=frames,
                simulate=simulate,
            )
            progress(number + 1, len(PLACEMENTS))
    return found


def comparison(found: dict[str, Placed]) -> Table:
    """Return one row for each LDF."""
    heads = ("before ms", "predicted ms", "simulated ms", "predicted %", "simulated %", "runs")
    table = new_table("A frame from each LDF, and how much shorter it gets", "LDF", *heads)
    for name, each in found.items():
        before = each.before_ms
        times = (before, each.predicted_ms, each.after_ms)
        gains = (percent(before - ms, before) for ms in times[1:])
        table.add_row(name, *(f"{ms:.2f}" for ms in times), *gains, str(1 + len(each.trials)))
    return table


@click.command()
@click.argument("recording", required=False, type=click.Path(path_type=Path))
@click.option("--frames", metavar="N", type=click.IntRange(min=1), help="Stop after N frames.")
def main(recording: Path | None, frames: int | None) -> None:
    """Place the built-in firmware from every shipped LDF on RECORDING, or on the built-in one."""
    try:
        print_report(comparison(place_all(recording, frames)))
    except BfsimError as error:
        raise click.ClickException(str(error)) from None


if __name__ == "__main__":
    main()
