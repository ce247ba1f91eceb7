"""`bfsim ldf`: where a linker description file puts things."""

from __future__ import annotations

from pathlib import Path

import click

from bfsim.cli.options.firmware import firmware_option
from bfsim.cli.options.hardware import BOARD_OPTIONS, COMPILER_OPTIONS
from bfsim.cli.options.json_file import json_option, require_json_place, tell
from bfsim.cli.options.ldf import PREPROCESSOR_OPTIONS
from bfsim.cli.options.sets import takes
from bfsim.cli.options.sizes import Size
from bfsim.process.terminal import print_report


@click.command(short_help="Print where an LDF puts buffers and code.")
@click.argument("file", required=False, type=click.Path(path_type=Path))
@firmware_option("place")
@takes((*BOARD_OPTIONS, *COMPILER_OPTIONS))
@click.option(
    "--size",
    type=Size(),
    metavar="WxH",
    default="320x240",
    show_default=True,
    help="Size of the pictures to make room for.",
)
@takes(PREPROCESSOR_OPTIONS)
@click.option("--symbols/--no-symbols", default=True, show_default=True, help="List every symbol.")
@click.option(
    "--picture",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Also draw the map, as FILE.png or FILE.svg.",
)
@json_option("the memory map")
def ldf(
    file: Path | None,
    *,
    firmware: str,
    board: str,
    settings: dict[str, str],
    profile: str,
    size: tuple[int, int],
    defines: dict[str, str],
    include_dirs: tuple[Path, ...],
    symbols: bool,
    picture: Path | None,
    json_path: Path | None,
) -> None:
    """Link the firmware by FILE and print the memory map: what lies where, what is free, and possible problems.

    FILE is a linker description file of VisualDSP++, or the name of a shipped one, such as l2; without it,
    the board's placement is shown. An LDF for other cores than the firmware's is shown without the firmware.

    \b
    Examples:
      bfsim ldf
      bfsim ldf l2 --size 640x480 --no-symbols
      bfsim ldf my.ldf --picture my.png -D USE_SDRAM -I vdk
    """
    from bfsim.files.save import require_place, write_bytes
    from bfsim.mapping import map_memory
    from bfsim.report.ldf.lint import lint
    from bfsim.report.ldf.picture import format_of, picture_bytes
    from bfsim.report.ldf.tables import ldf_json, ldf_report

    if picture:
        format_of(picture)
        require_place(picture)
    require_json_place(json_path, (file, picture))
    found = map_memory(
        file,
        firmware=firmware,
        board=board,
        settings=settings,
        profile=profile,
        width_px=size[0],
        height_px=size[1],
        defines=defines,
        include_dirs=include_dirs,
    )
    findings = lint(found)
    tell(
        json_path,
        lambda: [ldf_json(found, findings)],
        lambda: print_report(ldf_report(found, findings, symbols=symbols)),
    )
    if picture:
        write_bytes(picture, [picture_bytes(found, picture)])
