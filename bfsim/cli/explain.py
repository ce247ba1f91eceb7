"""`bfsim explain`: a kernel line by line, or instruction by instruction."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bfsim.cli.options.json_file import json_option, require_json_place, tell
from bfsim.cli.options.running import simulated, takes_a_run, warn
from bfsim.process.terminal import print_report

if TYPE_CHECKING:
    from bfsim.trace import RunRecord


@click.command(short_help="Print a kernel line by line: operations and cycles.")
@click.argument("kernel")
@takes_a_run
@click.option("--run", "runs", is_flag=True, help="Run the firmware first, and add how often each line ran.")
@json_option("the lines or instructions")
@click.option(
    "--asm",
    "as_assembly",
    is_flag=True,
    help="Print the compiler's instructions beneath the source lines, with their cycles, and what limits each loop; not with "
    "--profile vdsp-O2, which has no code.",
)
def explain(
    kernel: str,
    runs: bool,
    json_path: Path | None,
    as_assembly: bool,
    **what: Any,
) -> None:
    """Print the source of KERNEL with the operations chosen for each line and their cycles.

    KERNEL is FILE.py:NAME, PACKAGE:NAME, or only the NAME of a kernel of the firmware. With --run, or with a RECORDING,
    the firmware runs, and each line shows how often it was executed and its total cycles, including library routines that
    it calls, such as a division. --asm shows the same for each instruction.

    \b
    Examples:
      bfsim explain sobel_row
      bfsim explain sobel_row --run --frames 2
      bfsim explain sobel_row --asm --run --frames 2
      bfsim explain my_kernels:convolve --profile gcc-O2 --json
    """
    from bfsim.running.inputs import files_of_run

    require_json_place(json_path, files_of_run(what))
    runs = runs or what["recording"] is not None
    explained = _explain_code if as_assembly else _explain_lines
    if done := explained(kernel, runs=runs, json_path=json_path, **what):
        warn(done)


def _explain_lines(kernel: str, *, runs: bool, json_path: Path | None, **what: Any) -> RunRecord | None:
    """Print a kernel line by line; return the run, if there was one."""
    from bfsim.explain import explain_named
    from bfsim.report.kernels.explanation import explain_json, explain_report
    from bfsim.report.profile.library import in_callers

    named = kernel, what["firmware"], what["profile"]
    explanation = explain_named(*named)  # a mistake in a name is reported before the run
    done = simulated(**what) if runs else None
    if done:
        explanation = explain_named(*named, replace(done, kernels=in_callers(done.kernels)))
    tell(json_path, lambda: [explain_json(explanation)], lambda: print_report(explain_report(explanation)))
    return done


def _explain_code(kernel: str, *, runs: bool, json_path: Path | None, **what: Any) -> RunRecord | None:
    """Print the instructions that the profile's compiler makes of a kernel; return the run, if there was one."""
    from bfsim.assembly import Counting, find_code, listed
    from bfsim.compiling.toolchain import blackfin_compiler
    from bfsim.loading.firmware import load_firmware
    from bfsim.loading.hardware import find_profile
    from bfsim.loading.kernel_named import load_kernel
    from bfsim.report.kernels.assembly import assembly_json, assembly_report

    found = load_kernel(kernel, what["firmware"])
    firmware = load_firmware(what["firmware"])
    code = find_code(found, firmware, find_profile(what["profile"]).value, blackfin_compiler())
    counting = Counting(code)
    done = simulated(on_call=counting.see, **what) if runs else None
    assembly = listed(code, counting.events() if done else None)
    tell(json_path, lambda: [assembly_json(assembly)], lambda: print_report(assembly_report(assembly)))
    return done
