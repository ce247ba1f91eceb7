"""The command line: parses, calls, prints. Everything that takes time to import is imported by the command."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bfsim import __version__
from bfsim.cli_boards import boards
from bfsim.cli_check import check
from bfsim.cli_colours import colours
from bfsim.cli_diff import diff
from bfsim.cli_explain import explain
from bfsim.cli_export import export
from bfsim.cli_html import require_told, takes_html, writing_page
from bfsim.cli_ldf import ldf
from bfsim.cli_place import place
from bfsim.cli_profile import profile
from bfsim.cli_record import record
from bfsim.cli_running import exit_if_interrupted, simulated, takes_a_run, takes_work, warn
from bfsim.cli_seen import stages_named, takes_views, watching
from bfsim.cli_sweep import sweep
from bfsim.cli_timeline import takes_timelines, timelines
from bfsim.cli_verify import verify
from bfsim.endings import exit_code_of
from bfsim.errors import ConfigError
from bfsim.terminal import print_report
from bfsim.watchers import Watchers

if TYPE_CHECKING:
    from bfsim.report.target import Target

STDOUT = Path("-")


class _Bfsim(click.Group):
    """Ends every command with an exit code, and one that goes wrong for a known reason with one paragraph."""

    def main(self, *arguments: Any, standalone_mode: bool = True, **options: Any) -> Any:
        call = partial(super().main, *arguments, standalone_mode=False, **options)
        if standalone_mode:
            raise SystemExit(exit_code_of(call))
        return call()

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        if any("\0" in each for each in args):  # no system gives them, but callers in Python may
            raise click.UsageError("arguments must be without NUL characters")
        return super().parse_args(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:  # click would begin a new line
            raise click.Abort from None


@click.group(cls=_Bfsim, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="bfsim")
def main() -> None:
    """Simulate robot-vision firmware on a dual-core Blackfin ADSP-BF561, and report what each frame costs.

    Without arguments, `bfsim run` runs the built-in recording through the built-in firmware.

    Exit codes: 0 done, 1 a limit of `bfsim check` is broken, 2 a mistake in what was given, 70 a fault of bfsim's own;
    130 Ctrl-C, 143 SIGTERM, 129 SIGHUP, and 141 nobody reads the output any more.
    """


main.add_command(record)
main.add_command(boards)
main.add_command(check)
main.add_command(colours)
main.add_command(diff)
main.add_command(explain)
main.add_command(export)
main.add_command(ldf)
main.add_command(profile)
main.add_command(place)
main.add_command(sweep)
main.add_command(verify)


@main.command(short_help="Print what each frame costs: the timing budget.")
@takes_a_run
@takes_work
@click.option(
    "--json",
    "json_path",
    metavar="FILE",
    type=click.Path(path_type=Path, allow_dash=True),
    help="Write all records and the budget as JSON, too; - writes it to standard output instead of the tables.",
)
@click.option(
    "--features",
    is_flag=True,
    help="Add edges, blobs, lines and shapes of each picture to the JSON, beside objects, 3-D lines and 3-D edges.",
)
@click.option(
    "--full",
    is_flag=True,
    help="Print every table: stalls by reason, cycles, frames, results, configuration, digests.",
)
@takes_views
@takes_html
@takes_timelines
def run(
    json_path: Path | None,
    features: bool,
    full: bool,
    show: bool,
    overlay: Path | None,
    mcap: Path | None,
    layers: tuple[str, ...] | None,
    heat: str | None,
    html: Path | None,
    target: Target | None,
    trace: Path | None,
    flame: Path | None,
    **what: Any,
) -> None:
    """Run RECORDING through the firmware and print the frame timing budget on one screen.

    RECORDING is an MCAP file (see `bfsim record`); without it, the built-in soccer scene runs.

    \b
    Examples:
      bfsim run
      bfsim run drive.mcap --frames 20 --ldf l2
      bfsim run drive.mcap --set sdram.nRP=3 --set clocks.cclk_hz=500e6
      bfsim run --full --target 15Hz
      bfsim run drive.mcap --feed recorded --json drive.json
      bfsim run drive.mcap --overlay drive-seen --mcap drive-seen.mcap
      bfsim run drive.mcap --overlay lines.gif --layers lines,above
      bfsim run drive.mcap --overlay heat.gif --heat
      bfsim run drive.mcap --html drive.html --target 15Hz
      bfsim run drive.mcap --trace drive.pftrace
      bfsim run drive.mcap --record-work drive.work
      bfsim run drive.mcap --work drive.work --set clocks.cclk_hz=500e6
    """
    from bfsim.report.as_json import json_chunks
    from bfsim.report.save import files_of_run, require_apart, require_place, write_text
    from bfsim.report.screen import screen
    from bfsim.report.seen_json import SeenStore
    from bfsim.report.tables import run_report
    from bfsim.run import has_view

    read = files_of_run(what)
    if what["record_work"]:
        require_apart(what["record_work"], (*read[:-1], mcap, overlay))
    if json_path and json_path != STDOUT:
        require_place(json_path)
        require_apart(json_path, (*read, mcap, overlay))
    if features and not json_path:
        raise ConfigError("--features must come with --json FILE, which it adds to")
    require_told(target, html, is_json_only=json_path == STDOUT)
    is_telling = bool(json_path) and not what["work"] and has_view(what["firmware"])
    if features and not is_telling:
        raise ConfigError(
            f"--features must go with firmware that has a view to tell what it sees, and {what['firmware']} has none"
        )
    watchers = Watchers()
    with SeenStore(with_features=features) as seen:
        with (
            watching(
                watchers,
                show=show,
                overlay=overlay,
                mcap=mcap,
                layers=layers,
                heat=stages_named(heat, what["firmware"]),
            ),
            writing_page(watchers, html, target, what, (json_path, mcap, overlay)),
            timelines(watchers, trace, flame, (*read, json_path, mcap, overlay, html)),
        ):
            if is_telling:
                watchers.seen.append(seen.add)
            done = simulated(watchers=watchers, **what)
        if json_path == STDOUT:
            for chunk in json_chunks(done, seen):
                click.echo(chunk, nl=False)
            warn(done)
        else:
            print_report(run_report(done, target) if full else screen(done, target))
            if json_path:
                write_text(json_path, json_chunks(done, seen))
    exit_if_interrupted(done)
