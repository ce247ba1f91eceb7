"""Common parts of the commands that run firmware: the options for what to run, and the run with its progress bar."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bfsim.cli.options.firmware import firmware_option
from bfsim.cli.options.hardware import BOARD_OPTIONS, COMPILER_OPTIONS
from bfsim.cli.options.ldf import PREPROCESSOR_OPTIONS
from bfsim.cli.options.sets import takes
from bfsim.errors import ConfigError
from bfsim.process.signals import interrupted_code
from bfsim.process.terminal import progress_bar
from bfsim.running.watchers import Watchers, calling
from bfsim.shipped import LDFS

if TYPE_CHECKING:
    from bfsim.report.results.result import Result
    from bfsim.trace import RunRecord


_RUN_PARAMETERS = (
    click.argument("recording", required=False, type=click.Path(path_type=Path)),
    firmware_option("run"),
    *BOARD_OPTIONS,
    click.option(
        "--ldf",
        metavar="FILE",
        type=click.Path(path_type=Path),
        help=f"Linker description file that places buffers and code, or the name of a shipped one: {', '.join(LDFS)}.  [default: the board's]",
    ),
    *PREPROCESSOR_OPTIONS,
    *COMPILER_OPTIONS,
    click.option("--frames", metavar="N", type=click.IntRange(min=1), help="Stop after N frames."),
    click.option(
        "--feed",
        type=click.Choice(["demand", "recorded", "cameras"]),
        default="demand",
        show_default=True,
        help="When pictures come: as fast as the firmware asks, at the recorded time stamps, or at the free-running cameras' pace.",
    ),
    click.option(
        "--script",
        metavar="FILE",
        type=click.Path(path_type=Path),
        help="JSON or TOML file for the firmware's devices, such as orders for the robot; the firmware defines its contents.",
    ),
    click.option(
        "--fidelity",
        type=click.Choice(["fast", "detailed"]),
        default="fast",
        show_default=True,
        help="How the buses are simulated. `detailed` makes every transaction an event: much slower, to check `fast`.",
    ),
    click.option(
        "--sanitize",
        is_flag=True,
        help="Run every kernel twice, first as it is written, to find indices outside an array, divisions by zero, and shifts by "
        "less than 0 or more than 31, even in code that the compiler removes. Slower. Without it, estimated code checks "
        "indices and divisions, and compiled code that does not come with bfsim runs twice in the first frame only.",
    ),
)


takes_a_run = takes(_RUN_PARAMETERS)
"""Give a command the argument and the options that say what to run."""


_WORK_PARAMETERS = (
    click.option(
        "--record-work",
        metavar="FILE",
        type=click.Path(path_type=Path),
        help="Record the work of the cores, which --work plays on other hardware.",
    ),
    click.option(
        "--work",
        metavar="FILE",
        type=click.Path(path_type=Path),
        help="Play the work that --record-work recorded, on the board, settings and LDF given here, instead of running the "
        "firmware: the same cycles, faster.",
    ),
)


takes_work = takes(_WORK_PARAMETERS)
"""Give a command the options that record the work of a run, or play it again."""


def simulated(*, feed: str, fidelity: str, watchers: Watchers | None = None, **what: Any) -> RunRecord:
    """Run the simulation behind a progress bar. Raises ConfigError if no frame was finished."""
    from bfsim.run import Feed, Fidelity, simulate

    watchers = watchers or Watchers()
    with progress_bar("Simulating frames", unit="ms simulated") as bar:
        bar.say("compiling new kernels")  # nothing else takes long before the first frame

        def tell(done: int, total: int) -> None:
            bar.say("")
            bar(done, total)

        done = simulate(
            feed=Feed(feed),
            fidelity=Fidelity(fidelity),
            progress=tell,
            before=calling(watchers.before),
            on_seen=calling(watchers.seen),
            on_spans=calling(watchers.spans),
            on_time=lambda seconds: bar.reached(1000 * seconds),
            **what,
        )
    if done.interrupted and not done.frames:
        raise KeyboardInterrupt(f" before the first frame was done{done.interrupted_at}")
    if not done.frames:
        raise ConfigError("a run must have at least one frame to report on, and this one finished none")
    for each in watchers.done:
        each(done)
    return done


def run_and_seen(stack: ExitStack, watchers: Watchers | None = None, **what: Any) -> Result:
    """Return a run with what was seen in each frame, which is kept until the `stack` closes.

    Ends the command if the run is interrupted.
    """
    from bfsim.loading.firmware import load_firmware
    from bfsim.report.results.result import result_of
    from bfsim.report.results.seen_json import SeenStore

    seen = stack.enter_context(SeenStore(with_features=False))
    watchers = watchers or Watchers()
    if load_firmware(what["firmware"]).firmware.view:
        watchers.seen.append(seen.add)
    done = simulated(watchers=watchers, **what)
    exit_if_interrupted(done)
    return result_of(done, seen)


def warn(done: RunRecord) -> None:
    """Print the warnings of a run on standard error, for outputs without a place for them."""
    from bfsim.report.run.warnings import warnings_of

    for each in warnings_of(done):
        click.secho(f"bfsim: warning: {each.kind}: {each.text}", fg="yellow", err=True)


def exit_if_interrupted(done: RunRecord) -> None:
    """If the run was interrupted, end the command with the exit code for the cause."""
    if done.interrupted:
        click.echo(f"bfsim: interrupted after {len(done.frames)} frames{done.interrupted_at}", err=True)
        raise SystemExit(interrupted_code())
