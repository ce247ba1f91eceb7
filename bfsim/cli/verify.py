"""`bfsim verify`: estimates beside the real compiler's code."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from bfsim.cli.options.json_file import json_option, require_json_place, tell
from bfsim.cli.options.running import simulated, takes_a_run
from bfsim.process.terminal import print_report


@click.command(
    short_help="Compare the estimated cycles with those of the real compiler's code.",
    context_settings={"default_map": {"profile": "gcc-O2"}},
)
@takes_a_run
@click.option(
    "--calls",
    metavar="N",
    type=click.IntRange(min=1),
    default=16,
    show_default=True,
    help="Play at most N calls of each kernel, spread evenly over the run.",
)
@click.option(
    "--top",
    metavar="N",
    type=click.IntRange(min=1),
    default=20,
    show_default=True,
    help="Show the N kernels that cost most.",
)
@json_option("the comparison")
def verify(calls: int, top: int, json_path: Path | None, **what: Any) -> None:
    """Run RECORDING, then repeat the kernels' calls with GCC's code for the Blackfin.

    Every kernel is written as C (see `bfsim export`) and compiled by bfin-elf-gcc at the level of --profile; the code of
    the built-in firmware comes with bfsim. Its instructions are translated and run here. If the GNU simulator is
    installed, it runs them, too, and must take the same cycles in every call. These cycles, without memory, caches and
    interlocks, are compared with the issue cycles that the run estimates, and the results bit for bit. Exit code 1 if a
    bit, or a cycle of the translation, differs.

    \b
    Examples:
      bfsim verify --frames 2
      bfsim verify drive.mcap --firmware my_robot.py:firmware --profile gcc-O0
    """
    from bfsim.compiling.object_code import level_of, object_code
    from bfsim.compiling.toolchain import blackfin_compiler
    from bfsim.loading.firmware import load_firmware
    from bfsim.loading.hardware import find_profile
    from bfsim.loading.kernels import entries_of, kernels_of, written_in_python
    from bfsim.report.kernels.verification import verification_json, verification_report
    from bfsim.running.inputs import files_of_run
    from bfsim.verifying import Sampler
    from bfsim.verifying import verify as verified

    require_json_place(json_path, files_of_run(what))
    profile = find_profile(what["profile"]).value
    level_of(profile)
    tools = blackfin_compiler()
    sampler = Sampler(calls)
    done = simulated(on_call=sampler.see, **what)
    loaded = load_firmware(what["firmware"])
    entries = written_in_python(entries_of(loaded.firmware)) | set(sampler.of)
    code = object_code(written_in_python(kernels_of(loaded.own)) | entries, entries, profile, tools)
    found = verified(sampler, len(done.frames), profile, code, tools)
    tell(json_path, lambda: [verification_json(found)], lambda: print_report(verification_report(found, top)))
    if found.different or found.unequal:
        raise SystemExit(1)
