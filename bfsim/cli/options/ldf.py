"""Options of commands that take an LDF, for its preprocessor."""

from __future__ import annotations

import re
from pathlib import Path

import click

from bfsim.errors import shown


def _macros(_ctx: click.Context, _param: click.Parameter, given: tuple[str, ...]) -> dict[str, str]:
    """Return the macros by name; one without a value is 1, as with compilers."""
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
"""Options of every command that takes an LDF."""
