"""`bfsim profile`: where the cycles go, and why."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bfsim.cli.options.html import require_told, takes_html, writing_page
from bfsim.cli.options.json_file import STDOUT, json_option, require_json_place, tell
from bfsim.cli.options.running import exit_if_interrupted, simulated, takes_a_run, takes_work, warn
from bfsim.cli.options.timeline import takes_timelines, timelines
from bfsim.errors import ConfigError, shown
from bfsim.process.terminal import print_report
from bfsim.running.watchers import Watchers

if TYPE_CHECKING:
    from bfsim.report.budget.target import Target


@click.command(short_help="Print where the cycles go, down to source lines.")
@takes_a_run
@takes_work
@click.option("--core", type=click.Choice(["A", "B"]), help="Show one core only.  [default: both together]")
@click.option(
    "--top",
    metavar="N",
    type=click.IntRange(min=0),
    default=20,
    show_default=True,
    help="Show the N kernels, lines, buffers or callers that cost most.",
)
@click.option(
    "--by",
    type=click.Choice(["kernel", "line", "buffer", "reason", "frame", "caller"]),
    default="kernel",
    show_default=True,
    help="What to break the cycles down by; `frame` compares the worst frames with the median one.",
)
@click.option("--stage", metavar="NAME", help="Show one stage only, a row of the budget.")
@json_option("the whole profile")
@takes_html
@takes_timelines
def profile(
    core: str | None,
    top: int,
    by: str,
    stage: str | None,
    json_path: Path | None,
    html: Path | None,
    target: Target | None,
    trace: Path | None,
    flame: Path | None,
    **what: Any,
) -> None:
    """Run RECORDING and print where the cycles go, and why: three sentences, then a table.

    Every cycle has an owner: work, stalls and idling of each kernel, source line, ring, semaphore ... add up to the total of the frames.

    \b
    Examples:
      bfsim profile
      bfsim profile --by buffer --ldf sdram
      bfsim profile drive.mcap --by line --stage Edges
      bfsim profile drive.mcap --core A --top 40
      bfsim profile drive.mcap --trace drive.pftrace --flame drive.speedscope.json
    """
    from bfsim.report.profile.as_json import profile_json
    from bfsim.report.profile.tables import profile_report
    from bfsim.running.inputs import files_of_run

    require_json_place(json_path, (*files_of_run(what), html, trace, flame))
    require_told(target, html, is_json_only=json_path == STDOUT)
    if stage is not None:
        _require_stage(stage, what["firmware"])
    watchers = Watchers()
    with (
        writing_page(watchers, html, target, what),
        timelines(watchers, trace, flame, (*files_of_run(what), html)),
    ):
        done = simulated(watchers=watchers, **what)
    tell(
        json_path,
        lambda: [profile_json(done, core, stage, top)],
        lambda: print_report(profile_report(done, core, top, by, stage, target)),
    )
    if json_path == STDOUT:
        warn(done)
    exit_if_interrupted(done)


def _require_stage(stage: str, firmware: str) -> None:
    """Raise ConfigError unless the firmware has a stage of that name."""
    from bfsim.loading.firmware import load_firmware
    from bfsim.trace import REST

    known = [*(each.stage for each in load_firmware(firmware).firmware.rows), REST]
    if stage not in known:
        raise ConfigError(f"--stage must name one of {', '.join(known)}, not {shown(stage)}")
