"""The file of a recorded run: what its cores did, to be played on other hardware. Opening it runs nothing.

It is a ZIP file. `run.json` says what was run; each `CORE/NUMBER` is one `FrameWork` (`frame_file`), compressed with
LZ4; `end.json`, written last, has what was known only then.
"""

from __future__ import annotations

import json
import os
import struct
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import IO, Any

import lz4.block

from bfsim.errors import ConfigError, WorkError
from bfsim.fields import require_types
from bfsim.files.save import writing
from bfsim.kernel import keys
from bfsim.machine.retiming.packed_work import PackedWork
from bfsim.machine.retiming.work import FrameWork
from bfsim.machine.retiming.work_check import check
from bfsim.recording.stereo.stereo_check import Counts
from bfsim.running import frame_file
from bfsim.running.digested_frames import KnownFrames

FORMAT = 9
PACKED_HOW_WELL = 3
"""Level of compression, of 1 to 12: each higher one packs 3 % better, in 1.3 to 2 times the time."""
LOCAL_HEAD, ENCRYPTED = struct.Struct("<26xHH"), 1
"""The header of a part of a ZIP file, up to the lengths of its name and extra field; and the flag of encrypted parts."""
LARGEST_FRAME_BYTES = 1 << 30
"""The most bytes that a frame may decompress to: some hundred times those of the built-in firmware's in SDRAM."""

_DAMAGE = (
    ValueError, LookupError, TypeError, ArithmeticError, RuntimeError, EOFError, MemoryError, struct.error, zlib.error, zipfile.BadZipFile,
    lz4.block.LZ4BlockError,
)  # fmt: skip
"""Errors of reading a broken file: depending on the damage, Python may take a ZIP for encrypted or a later version."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Recorded:
    """What was run.

    `identity` are fields of the run's `Identity`. `buffers` are those of each owner of memory, by name and bytes.
    `is_bound`: whether the accesses depend on where everything lies. `routines_outside`: core and name of each routine
    outside L1. `frames`: those of the recording. `modules`: the firmware's. `doubts`: what the check of the frames
    found. `obstacles`: why the run cannot be played, in words.
    """

    identity: Mapping[str, str]
    buffers: tuple[tuple[str, int], ...]
    is_bound: bool
    routines_outside: tuple[tuple[str, str], ...]
    frames: KnownFrames
    modules: tuple[str, ...]
    firmware_digest: str
    doubts: Counts
    obstacles: tuple[str, ...]


class WorkWriter(AbstractContextManager["WorkWriter"]):
    """Writes a file as the run goes on. Without `end` the file is not valid."""

    def __init__(self, stream: IO[bytes], path: Path) -> None:
        """`path`: where the file will be, for messages."""
        self._path = path
        self._zip = zipfile.ZipFile(stream, "w")
        self._counts: dict[str, int] = {}
        self._obstacles: dict[str, None] = {}

    @property
    def obstacles(self) -> Sequence[str]:
        """Why the run cannot be played again, in words; empty for most runs."""
        return [*self._obstacles]

    def begin(self, **what: Any) -> None:
        """Write what is known of the run before it begins."""
        self._write("run.json", json.dumps({"format": FORMAT, "costs": keys.compiler(), **what}).encode())

    def add(self, work: FrameWork) -> None:
        """Write what a core did in a frame."""
        number = self._counts[work.core] = self._counts.get(work.core, 0) + 1
        self._write(f"{work.core}/{number - 1:06}", compressed(frame_file.written(work)))

    def add_obstacle(self, text: str) -> None:
        """Note why the run cannot be played again."""
        self._obstacles[text] = None

    def end(self, frames: KnownFrames, **what: Any) -> None:
        """Write what is known at the end; this completes the file."""
        known = {"obstacles": self.obstacles, "frames": asdict(frames), **what}
        self._write("end.json", json.dumps(known).encode())
        with writing(self._path):
            self._zip.close()

    def __exit__(self, *_: object) -> None:
        with suppress(OSError):  # the first error is already on its way
            self._zip.close()

    def _write(self, name: str, content: bytes) -> None:
        with writing(self._path):
            self._zip.writestr(zipfile.ZipInfo(name), content)


class WorkReader:
    """A complete file of this version."""

    def __init__(self, path: Path, file: IO[bytes], zipped: zipfile.ZipFile) -> None:
        self.path = path
        self._file = file.fileno()
        self._zip = zipped
        run, end = self._json("run.json"), self._json("end.json")
        if run.get("format") != FORMAT or run.get("costs") != keys.compiler():
            raise WorkError(
                f"{path} must be recorded by this version of bfsim, as others may time kernels differently; record it again"
            )
        try:
            what = _tuples({**run, **end})
            what["frames"] = KnownFrames(**what["frames"])
            self.recorded = Recorded(**{each.name: what[each.name] for each in fields(Recorded)})
            require_types(self.recorded, "run")
        except (KeyError, TypeError, ValueError, ConfigError, RecursionError) as error:
            raise self._broken() from error

    def works(self, core: str) -> Iterator[PackedWork]:
        """Yield what a core did, frame by frame."""
        names = [each for each in self._zip.namelist() if each.startswith(f"{core}/")]
        for name in names:
            try:
                work = frame_file.read(core, decompressed(self._stored(self._zip.getinfo(name))))
                check(work, len(self.recorded.buffers))
            except (*_DAMAGE, OSError) as error:
                raise self._broken() from error
            yield work

    def _stored(self, part: zipfile.ZipInfo) -> bytes:
        """Return a part as it stands in the file: zipfile takes longer for this than unpacking takes."""
        if part.compress_type != zipfile.ZIP_STORED or part.flag_bits & ENCRYPTED:
            raise ValueError("a part must be stored as it is")
        head = os.pread(self._file, LOCAL_HEAD.size, part.header_offset)
        content = os.pread(
            self._file, part.file_size, part.header_offset + len(head) + sum(LOCAL_HEAD.unpack(head))
        )
        if zlib.crc32(content) != part.CRC:
            raise ValueError("a part must be whole")
        return content

    def _json(self, name: str) -> dict[str, Any]:
        try:
            found = json.loads(self._zip.read(name))
        except (*_DAMAGE, OSError) as error:
            raise self._broken() from error
        if not isinstance(found, dict):
            raise self._broken()
        return found

    def _broken(self) -> WorkError:
        return WorkError(
            f"{self.path} must be a complete file of `bfsim run --record-work`, but is not; record it again"
        )


@contextmanager
def opened(path: Path) -> Iterator[WorkReader]:
    """Open a file. Raises WorkError if it is cut, broken, something else, or from another version."""
    if path.exists() and not path.is_file():
        raise WorkError(f"{path} must be an ordinary file, not a folder or a device")
    try:
        file = path.open("rb")
    except OSError as error:
        raise WorkError(f"{path} must be a file that can be read: {error.strerror}") from error
    with file:
        try:
            zipped = zipfile.ZipFile(file)
        except (*_DAMAGE, OSError) as error:
            raise WorkError(
                f"{path} must be a complete file of `bfsim run --record-work`, but is not; record it again"
            ) from error
        with zipped:
            yield WorkReader(path, file, zipped)


def _tuples(value: Any) -> Any:
    """Return a value read from JSON, with tuples in place of lists."""
    if isinstance(value, dict):
        return {name: _tuples(each) for name, each in value.items()}
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


def compressed(content: bytes) -> bytes:
    """Return a frame as it stands in the file: its size, then LZ4, which unpacks in a third of others' time."""
    packed: bytes = lz4.block.compress(content, mode="high_compression", compression=PACKED_HOW_WELL)
    return packed


def decompressed(content: bytes) -> bytes:
    """Return a frame. Raises ValueError or LZ4BlockError for invalid content."""
    if not 0 < int.from_bytes(content[:4], "little") <= LARGEST_FRAME_BYTES:
        raise ValueError("a frame must say how large it is, and not be larger than any")
    unpacked: bytes = lz4.block.decompress(content)
    return unpacked
