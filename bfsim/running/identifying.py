"""What a run depends on: names and digests, and the frames of a recording, whose digest grows as they are read."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator, Sequence
from pathlib import Path

import llvmlite.binding as llvm

from bfsim import __version__, shipped
from bfsim.errors import WorkError
from bfsim.loading.firmware import compilers_of
from bfsim.process.reading_ahead import read_ahead
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.running.setup import FittedFirmware, RunSetup
from bfsim.trace import Identity


class DigestedFrames:
    """The frames of a recording as they are read, and the digest of those that were."""

    def __init__(self, reader: RecordingReader, total: int) -> None:
        self.name = name_of(Path(reader.path))
        self._reader = reader
        self.total = total
        self.digests: list[str] = []
        """Of the recording up to each frame that was read."""
        self._expected: Sequence[str] = ()
        self._times_ns: dict[int, dict[str, int]] = {}

    def __iter__(self) -> Iterator[StereoFrame]:
        for frame, digest in read_ahead(self._with_digests()):
            self.digests.append(digest)
            if self._expected and self._expected[frame.index] != self.digests[-1]:
                raise WorkError(
                    f"{self.name} must be as it was when its run was recorded, and frame {frame.index} is another: record it again"
                )
            self._times_ns[frame.index] = {"left": frame.left_ns, "right": frame.right_ns}
            yield frame

    def _with_digests(self) -> Iterator[tuple[StereoFrame, str]]:
        """Yield frames with the digest of the recording up to each."""
        digest = hashlib.sha256()
        for frame in self._reader.frames(self.total):
            digest.update(f"{frame.left.shape} {frame.left_ns} {frame.right_ns}\n".encode())
            digest.update(frame.left.tobytes())
            digest.update(frame.right.tobytes())
            yield frame, digest.hexdigest()

    def expect(self, digests: Sequence[str]) -> None:
        """Compare each frame that is read from now on with what was read before. Raises WorkError for another one."""
        self._expected = digests

    def take_times_ns(self, index: int) -> dict[str, int]:
        """Return when the pictures of a frame were taken, by camera."""
        return self._times_ns.pop(index)

    @property
    def digest(self) -> str:
        """Digest of the pixels and time stamps read so far."""
        return self.digests[-1] if self.digests else hashlib.sha256().hexdigest()


def recording_digest(recording: Path | str | None, frames: int) -> str:
    """Digest of the first `frames` frames of a recording, as in the identity of a run; empty where there are fewer."""
    with RecordingReader(recording or shipped.RECORDING) as reader:
        source = DigestedFrames(reader, frames)
        return source.digest if sum(1 for _ in source) == frames else ""


def name_of(path: Path) -> str:
    """Return the name of a file as an identity has it."""
    return written(path.name)


def written(path: str | Path) -> str:
    """Return a path or a name as text that can be written, also where it is none."""
    return os.fsencode(path).decode(errors="replace")


def identity_of(setup: RunSetup, fitted: FittedFirmware, recording: str) -> Identity:
    """Return what a run of a recording of that name depends on; its digest is known only when its frames have been read."""
    board, compiler, loaded, placement = setup.board, setup.compiler, setup.loaded, setup.placement
    names = [name_of(placement.path), *(f"{name}={value}" for name, value in setup.defines.items())]
    return Identity(
        recording=recording,
        recording_digest="",
        firmware=loaded.name,
        firmware_digest=loaded.digest,
        firmware_files=loaded.files,
        board=board.value.name,
        board_digest=board.digest,
        board_files=board.files,
        board_numbers=board.numbers,
        ldf=" -D ".join(names),
        ldf_digest=hashlib.sha256(placement.source.expanded.encode()).hexdigest(),
        compiler=compiler.value.name,
        compiler_digest=compiler.digest,
        compiler_files=compiler.files,
        compiler_numbers=compiler.numbers,
        code=fitted.build.code,
        code_digest=fitted.build.digest,
        file_compiler=", ".join(sorted(compilers_of(loaded))),
        feed=setup.feed.value,
        script_digest=setup.script_digest,
        fidelity=setup.fidelity.value,
        bfsim_version=__version__,
        llvm_version=".".join(map(str, llvm.llvm_version_info)),
        cclk_hz=float(board.value.clocks.cclk_hz),
        sclk_hz=float(board.value.clocks.sclk_hz),
        width_px=fitted.size.width_px,
        height_px=fitted.size.height_px,
    )
