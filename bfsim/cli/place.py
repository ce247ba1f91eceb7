"""`bfsim place`: the placement of buffers and code with the shortest frame."""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from bfsim.cli.options.json_file import STDOUT, json_option, require_json_place, tell
from bfsim.cli.options.running import exit_if_interrupted, simulated, takes_a_run
from bfsim.errors import ConfigError
from bfsim.process.signals import uninterrupted
from bfsim.process.terminal import print_report

if TYPE_CHECKING:
    from bfsim.trace import RunRecord


@click.command(short_help="Find the placement of buffers and code with the shortest frame.")
@takes_a_run
@click.option(
    "-o",
    "--output",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Write the placement as an LDF; `bfsim run --ldf FILE` runs it.",
)
@click.option("--force", is_flag=True, help="Overwrite the LDF if it exists.")
@click.option(
    "--top",
    metavar="N",
    type=click.IntRange(min=0),
    default=12,
    show_default=True,
    help="Show the N moves that save most.",
)
@json_option("every buffer and why it lies where it does")
def place(output: Path | None, force: bool, top: int, json_path: Path | None, **what: Any) -> None:
    """Run RECORDING, and find where buffers and code must lie for the shortest frame.

    The run measures the accesses to each buffer and the waits for it. An integer programme then assigns each buffer to
    one of the LDF's memories so that the slower core's frame is shortest. The result is run, and the search repeated from
    its measurements, as long as it gets faster. Code moves, too, if some of it lies outside L1. Segments, reserves, stack,
    heap and caches stay as in the LDF: --ldf cache finds the best placement with caches.

    \b
    Examples:
      bfsim place -o placed.ldf
      bfsim place drive.mcap --ldf sdram --frames 4 -o placed.ldf
      bfsim place drive.mcap --firmware mine.py:firmware --board bf561-ezkit
      bfsim run drive.mcap --ldf placed.ldf
      bfsim ldf placed.ldf --picture placed.png
    """
    from bfsim.files.save import require_apart, require_place, write_text

    with uninterrupted():  # SciPy and NumPy take Ctrl-C for a part of theirs that is not there
        from bfsim.placing.search import place as found_by
        from bfsim.placing.tables import placed_json, placed_report
    from bfsim.running.inputs import files_of_run

    if output:
        require_place(output)
        require_apart(output, files_of_run(what))
        if output.exists() and not force:
            raise ConfigError(f"{output} must not exist yet; --force overwrites it")
    require_json_place(json_path, (*files_of_run(what), output))
    placed = found_by(simulate=_whole_run, **what)

    def write() -> None:
        if output and placed.ldf:
            write_text(output, placed.ldf)

    tell(json_path, lambda: [placed_json(placed)], lambda: print_report(placed_report(placed, top)), write)
    if output and json_path != STDOUT:
        file = shlex.quote(str(output))
        others = ",\nwith the other options that were given here" if has_others(what) else ""
        click.echo(
            f"Written: `bfsim run --ldf {file}` runs it, `bfsim ldf {file}` draws it{others}."
            if placed.ldf
            else f"{output} was not written: {placed.start} is as good."
        )


def has_others(what: Iterable[str]) -> bool:
    """Whether the command line gives more than the LDF to run."""
    ctx = click.get_current_context()
    said = {each for each in what if ctx.get_parameter_source(each) is ParameterSource.COMMANDLINE}
    return bool(said - {"ldf"})


def _whole_run(**what: Any) -> RunRecord:
    """Run the simulation to its end."""
    done = simulated(**what)
    exit_if_interrupted(done)
    return done
