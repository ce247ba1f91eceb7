"""`bfsim run`: what each frame costs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bfsim.cli.options.html import require_told, takes_html, writing_page
from bfsim.cli.options.json_file import STDOUT, json_option, require_json_place, tell
from bfsim.cli.options.running import exit_if_interrupted, simulated, takes_a_run, takes_work, warn
from bfsim.cli.options.seen import stages_named, takes_views, watching
from bfsim.cli.options.timeline import takes_timelines, timelines
from bfsim.errors import ConfigError
from bfsim.process.terminal import print_report
from bfsim.running.watchers import Watchers

if TYPE_CHECKING:
    from bfsim.report.budget.target import Target


@click.command(short_help="Print what each frame costs: the timing budget.")
@takes_a_run
@takes_work
@json_option("all records and the budget")
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
    from bfsim.files.save import require_apart
    from bfsim.loading.firmware import load_firmware
    from bfsim.report.results.as_json import json_chunks
    from bfsim.report.results.seen_json import SeenStore
    from bfsim.report.run.full import run_report
    from bfsim.report.run.screen import screen
    from bfsim.running.inputs import files_of_run

    read = files_of_run(what)
    if what["record_work"]:
        require_apart(what["record_work"], (*read[:-1], mcap, overlay))
    require_json_place(json_path, (*read, mcap, overlay))
    if features and not json_path:
        raise ConfigError("--features must come with --json, which it adds to")
    require_told(target, html, is_json_only=json_path == STDOUT)
    is_telling = bool(json_path and not what["work"] and load_firmware(what["firmware"]).firmware.view)
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
        tell(
            json_path,
            lambda: json_chunks(done, seen),
            lambda: print_report(run_report(done, target) if full else screen(done, target)),
        )
    if json_path == STDOUT:
        warn(done)
    exit_if_interrupted(done)
