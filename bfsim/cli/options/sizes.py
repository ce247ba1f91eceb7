"""The type of options that take a width and a height."""

from __future__ import annotations

import re

import click

from bfsim.errors import shown


class Size(click.ParamType[tuple[int, int]]):
    """Width and height, such as 320x240: 1 to 9999 each."""

    name = "WxH"

    def convert(
        self, value: str | tuple[int, int], param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, int]:
        """Return the two numbers; a default is a pair already."""
        if isinstance(value, tuple):
            return value
        found = re.fullmatch(r"([1-9][0-9]{0,3})x([1-9][0-9]{0,3})", value)
        if found is None:
            self.fail(
                f"must be width x height, such as 320x240, 1 to 9999 each, not {shown(value)}", param, ctx
            )
        return int(found[1]), int(found[2])
