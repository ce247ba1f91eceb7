"""`bfsim colours`: what firmware calls each colour of a picture."""

from __future__ import annotations

import re
from pathlib import Path

import click

from bfsim.cli.options.firmware import firmware_option
from bfsim.cli.options.json_file import json_option, require_json_place, tell
from bfsim.errors import ConfigError, shown
from bfsim.process.terminal import print_report
from bfsim.shipped import RECORDING


class _Area(click.ParamType[tuple[int, int, int, int]]):
    """Left and top, width and height, such as 10,20,64x48."""

    name = "X,Y,WxH"

    def convert(
        self, value: str, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, int, int, int]:
        found = re.fullmatch(r"(\d{1,5}),(\d{1,5}),([1-9]\d{0,4})x([1-9]\d{0,4})", value, re.ASCII)
        if found is None:
            self.fail(f"must be left,top,width x height, such as 10,20,64x48, not {shown(value)}", param, ctx)
        left, top, width, height = map(int, found.groups())
        return left, top, width, height


@click.command(short_help="Show what the firmware calls each colour of a picture.")
@click.argument("picture", required=False, type=click.Path(path_type=Path))
@firmware_option("ask")
@click.option(
    "--frame",
    metavar="N",
    type=click.IntRange(min=0),
    help="Which frame of a recording, from 0; its left picture is taken.  [default: 0]",
)
@click.option(
    "--script",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="JSON or TOML file as for `bfsim run`: colours use the thresholds that hold in that frame.",
)
@click.option(
    "--grey",
    type=_Area(),
    metavar="X,Y,WxH",
    help="A patch of the picture that is grey or white, to measure the white balance by.",
)
@click.option(
    "--out",
    metavar="FILE.png",
    type=click.Path(path_type=Path),
    help="Draw the picture and its colours side by side.",
)
@json_option("the colours")
def colours(
    picture: Path | None,
    firmware: str,
    frame: int | None,
    script: Path | None,
    grey: tuple[int, int, int, int] | None,
    out: Path | None,
    json_path: Path | None,
) -> None:
    """Print what the firmware calls each colour of PICTURE, in degrees of its hue, and how much of the picture has it.

    PICTURE is an image file, or a recording (see `bfsim record`); without it, the built-in one. Below the table the
    firmware says which white balance would make the picture grey on average, or with --grey the patch.

    \b
    Examples:
      bfsim colours ball.jpg
      bfsim colours ball.jpg --out ball-colours.png
      bfsim colours drive.mcap --frame 12 --script orders.json
      bfsim colours ball.jpg --grey 40,200,64x32
    """
    from bfsim.colouring import coloured
    from bfsim.files.save import require_apart, require_place, write_bytes
    from bfsim.report.colours import colours_json, colours_picture, colours_report

    if out:
        if out.suffix.lower() != ".png":
            raise ConfigError(f"--out must be a file *.png, not {out}")
        require_place(out)
        require_apart(out, (picture, script))
    require_json_place(json_path, (picture, script, out))
    done = coloured(picture or RECORDING, firmware=firmware, script=script, frame=frame, grey=grey)
    if out:
        write_bytes(out, [colours_picture(done.picture, done.colours)])
    told = done.colours, done.patch_notes
    tell(json_path, lambda: [colours_json(*told)], lambda: print_report(colours_report(*told)))
