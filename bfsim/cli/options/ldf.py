"""The options of commands that take an LDF: what its preprocessor is told."""

from __future__ import annotations

import re
from pathlib import Path

import click

from bfsim.errors import shown


def _macros(_ctx: click.Context, _param: click.Parameter, given: tuple[str, ...]) -> dict[str, str]:
    """Return the macros by their names; one without a value is 1, as compilers have it."""
    macros = {}
    for each in given:
        name, has_value, value = each.partition("=")
        if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
            raise click.BadParameter(f"must be NAME or NAME=VALUE, not {shown(each)}")
        macros[name] = value if has_value else "1"
    return macros


PREPROCESSOR_OPTIONS = (
    click.option(
        "-D",
        "defines",
        metavar="NAME[=VALUE]",
        multiple=True,
        callback=_macros,
        help="Define a macro for the LDF, such as USE_SDRAM.",
    ),
    click.option(
        "-I",
        "include_dirs",
        metavar="FOLDER",
        multiple=True,
        type=click.Path(path_type=Path),
        help="Also search this folder for files that the LDF includes.",
    ),
)
"""What every command takes that takes an LDF."""
