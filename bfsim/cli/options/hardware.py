"""The options that say what a firmware runs on: the board, its numbers, and the compiler."""

from __future__ import annotations

from pathlib import Path

import click

from bfsim.errors import shown


def _settings(_ctx: click.Context, _param: click.Parameter, given: tuple[str, ...]) -> dict[str, str]:
    """Return the values by their paths."""
    settings: dict[str, str] = {}
    for each in given:
        path, has_value, value = each.partition("=")
        path = path.strip()
        if not (path and has_value):
            raise click.BadParameter(f"must be PATH=VALUE, such as sdram.nRP=3, not {shown(each)}")
        if path in settings:
            raise click.BadParameter(f"{shown(path)} must be set once, not twice")
        settings[path] = value
    return settings


SET_OPTION = click.option(
    "--set",
    "settings",
    metavar="PATH=VALUE",
    multiple=True,
    callback=_settings,
    help="Change a number of the board, such as sdram.nRP=3 or clocks.cclk_hz=500e6; `bfsim boards NAME` has the paths.",
)
BOARD_OPTIONS = (
    click.option(
        "--board",
        metavar="NAME",
        default="cm-bf561",
        show_default=True,
        help="Board to run on; `bfsim boards` lists them. Or your own, FILE.py:NAME or PACKAGE:NAME.",
    ),
    SET_OPTION,
)


def _toolchain(_ctx: click.Context, _param: click.Parameter, folder: Path | None) -> None:
    if folder is not None:
        from bfsim.compiling.toolchain import prefer  # most commands need none

        prefer(folder)


COMPILER_OPTIONS = (
    click.option(
        "--profile",
        metavar="NAME",
        default="gcc-adi",
        show_default=True,
        help="Compiler whose code is costed. gcc-adi and gcc run GCC's code of the kernels, if there is any, timed as Analog Devices "
        "documents it or as the GNU simulator does. gcc-O2, gcc-O0 and vdsp-O2 are estimates. Or your own, FILE.py:NAME or "
        "PACKAGE:NAME.",
    ),
    click.option(
        "--toolchain",
        metavar="FOLDER",
        type=click.Path(path_type=Path, exists=True, file_okay=False),
        callback=_toolchain,
        is_eager=True,
        expose_value=False,
        help="Folder with bfin-elf-gcc and bfin-elf-run, the GNU simulator.  [default: the PATH]",
    ),
)
