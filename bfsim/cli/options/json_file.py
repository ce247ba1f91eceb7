"""The option of commands that write their result as JSON, too."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

STDOUT = Path("-")
"""The file that stands for standard output: it gets the JSON in place of the tables."""


def json_option(what: str) -> Callable[[Any], Any]:
    """Return the option `--json FILE`, which is `json_path` to the command; `what` stands in its help."""
    return click.option(
        "--json",
        "json_path",
        metavar="FILE",
        type=click.Path(path_type=Path, allow_dash=True),
        help=f"Write {what} as JSON, too; - writes it to standard output instead of the tables.",
    )
