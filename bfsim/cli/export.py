"""`bfsim export`: the kernels of firmware as C."""

from __future__ import annotations

from pathlib import Path

import click


@click.command(short_help="Write the kernels of firmware as C99.")
@click.argument("firmware")
@click.argument("folder", type=click.Path(path_type=Path))
@click.option(
    "--line-directives",
    is_flag=True,
    help="Add #line, so that the compiler's messages and a debugger point to the Python.",
)
@click.option("--force", is_flag=True, help="Overwrite existing files.")
def export(firmware: str, folder: Path, line_directives: bool, force: bool) -> None:
    """Write the kernels of FIRMWARE to FOLDER as C99, with a header and a makefile.

    FIRMWARE is the name of a built-in one, FILE.py:NAME or PACKAGE:NAME, from the current folder first. Each Python file becomes one
    of C, with its own names, comments and docstrings; helpers that only their file calls are static.

    \b
    Examples:
      bfsim export my_robot.py:firmware c
      make -C c                              for the Blackfin, with bfin-elf-gcc
      make -C c CC=gcc CPU=                  for this machine
    """
    from bfsim.exporting import export as written

    done = written(firmware, folder, line_directives=line_directives, force=force)
    kernels = f"{done.kernels} kernel{'s' if done.kernels != 1 else ''}"
    click.echo(f"{kernels}, {done.lines:,} lines of C in {done.folder}")
    if done.left:
        click.echo(f"Left out, for they are not written in Python: {', '.join(done.left)}")
