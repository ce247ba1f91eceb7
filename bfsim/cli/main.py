"""The command line: parse, call, print. Commands import slow modules themselves."""

from __future__ import annotations

from functools import partial
from typing import Any

import click

from bfsim import __version__
from bfsim.cli.boards import boards
from bfsim.cli.check import check
from bfsim.cli.colours import colours
from bfsim.cli.diff import diff
from bfsim.cli.explain import explain
from bfsim.cli.export import export
from bfsim.cli.ldf import ldf
from bfsim.cli.place import place
from bfsim.cli.profile import profile
from bfsim.cli.record import record
from bfsim.cli.run import run
from bfsim.cli.sweep import sweep
from bfsim.cli.verify import verify
from bfsim.process.endings import exit_code_of


class _Bfsim(click.Group):
    """Ends every command with an exit code; known errors print one paragraph."""

    def main(self, *arguments: Any, standalone_mode: bool = True, **options: Any) -> Any:
        call = partial(super().main, *arguments, standalone_mode=False, **options)
        if standalone_mode:
            raise SystemExit(exit_code_of(call))
        return call()

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        if any("\0" in each for each in args):  # no shell passes these, but Python callers may
            raise click.UsageError("arguments must be without NUL characters")
        return super().parse_args(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as error:  # click would begin a new line
            raise click.Abort(str(error)) from None


@click.group(cls=_Bfsim, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="bfsim")
def main() -> None:
    """Simulate robot-vision firmware on a dual-core Blackfin ADSP-BF561, and report what each frame costs.

    Without arguments, `bfsim run` runs the built-in recording through the built-in firmware.

    Exit codes: 0 success; 1 a broken limit of `bfsim check`, or a difference of `bfsim verify`; 2 a mistake in the input;
    70 a bug of bfsim; 130 Ctrl-C; 143 SIGTERM; 129 SIGHUP; 141 nobody reads the output any more.
    """


for command in (
    run,
    record,
    boards,
    check,
    colours,
    diff,
    explain,
    export,
    ldf,
    profile,
    place,
    sweep,
    verify,
):
    main.add_command(command)
