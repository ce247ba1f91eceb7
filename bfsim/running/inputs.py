"""What a run reads besides its frames: its files, the LDF, and what a recording knows of its cameras."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bfsim import shipped
from bfsim.chip.spec import BoardSpec
from bfsim.errors import LinkError, shown
from bfsim.linker import LinkerScript, parse_ldf
from bfsim.loading.locating import file_named
from bfsim.machine.buffers import FrameSize
from bfsim.machine.program import Calibration, SourcePixels
from bfsim.process.once import once
from bfsim.recording import RecordingReader


def files_of_run(what: Mapping[str, Any]) -> tuple[Path | None, ...]:
    """Return the files of a run with the arguments `what` of `simulate`: those it reads, then where it records its work."""
    sources = (what.get(name) for name in ("firmware", "board", "profile"))
    names = (what.get(name) for name in ("recording", "ldf", "script", "work", "record_work"))
    return (
        *(file_named(name) if isinstance(name, str) else None for name in sources),
        *(name if name is None else Path(name) for name in names),
    )


def read_placement(
    ldf: Path | str | None, spec: BoardSpec, defines: Mapping[str, str], include_dirs: Sequence[Path | str]
) -> LinkerScript:
    """Read an LDF for chip and SDRAM of the board: a file, a shipped one by its name, or the one that suits the chip.

    `defines` are macros that add to those of bfsim, or replace them. Raises LinkError if there is no such LDF or
    it is not one.
    """
    path = shipped.ldf_at(Path(ldf)) if ldf else shipped.DEFAULT_LDFS[spec.chip.name]
    if path is None:
        known = ", ".join(shipped.LDFS)
        raise LinkError(f"LDF must be a file or a shipped one ({known}), not {shown(str(ldf))}")
    macros = {"SDRAM_BANK_BYTES": str(spec.sdram.bank_bytes), **defines}
    folders = (*map(Path, include_dirs), shipped.LDF_FOLDER)
    return _script(path, macros, folders, spec.chip.name)


@once
def _script(path: Path, macros: Mapping[str, str], include_dirs: Sequence[Path], chip: str) -> LinkerScript:
    return parse_ldf(path, macros, include_dirs, chip).with_cores_named()


@once
def opened(recording: Path | str) -> RecordingReader:
    """Open a recording. Of runs planned together, all but the first get a closed reader that knows what it has read."""
    return RecordingReader(recording)


@once
def calibration_of(reader: RecordingReader) -> Calibration:
    """Return what a recording knows of its cameras: tables by the cores that take them, and the geometry."""
    tables, geometry = reader.rectification, reader.geometry
    pictures = (("A", tables.left), ("B", tables.right)) if tables else ()
    return Calibration(
        size=FrameSize(reader.width, reader.height),
        sources={core: SourcePixels(*table) for core, table in pictures},
        geometries=(geometry,) if geometry else (),
    )
