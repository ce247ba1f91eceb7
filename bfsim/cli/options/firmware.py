"""The option that names firmware."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from bfsim.shipped import FIRMWARE


def firmware_option(verb: str) -> Callable[[Any], Any]:
    """Return `--firmware`; `verb` is what the command does with it."""
    return click.option(
        "--firmware",
        metavar="NAME",
        default=FIRMWARE[0],
        show_default=True,
        help=f"Firmware to {verb}: {', '.join(FIRMWARE)} (built in), or your own, FILE.py:NAME or PACKAGE:NAME, from the current folder first.",
    )
