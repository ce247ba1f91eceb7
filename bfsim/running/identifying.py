"""What a run depends on, as names and digests; the frames of a recording, and their digest as they are read."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import llvmlite.binding as llvm
import numpy as np

from bfsim import __version__, shipped
from bfsim.errors import WorkError
from bfsim.loading.firmware import compilers_of
from bfsim.process.reading_ahead import read_ahead
from bfsim.recording import RecordingReader, StereoFrame
from bfsim.running.setup import FittedFirmware, RunSetup
from bfsim.trace import Identity


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownFrames:
    """Frames that have been read: `digests` of the recording up to each, `times_ns` of its left and right picture.

    `stored_digest` covers the file up to byte `stored_end`, as far as it was read.
    """

    digests: tuple[str, ...]
    times_ns: tuple[tuple[int, int], ...]
    stored_end: int
    stored_digest: str

    def __post_init__(self) -> None:
        if len(self.digests) != len(self.times_ns):
            raise ValueError("each frame must have a digest and its times")


class DigestedFrames:
    """The frames of a recording as they are read, and the digest of those read so far."""

    def __init__(self, reader: RecordingReader, total: int) -> None:
        self.name = name_of(Path(reader.path))
        self._reader = reader
        self.total = total
        self.digests: list[str] = []
        """Digests of the recording up to each frame that was read."""
        self._expected: KnownFrames | None = None
        self._times_ns: list[tuple[int, int]] = []

    def __iter__(self) -> Iterator[StereoFrame]:
        expected = self._expected
        if expected and self._reader.stored_digest(expected.stored_end) == expected.stored_digest:
            frames = self._unseen(expected)
        else:
            frames = read_ahead(self._with_digests())
        for frame, digest in frames:
            self.digests.append(digest)
            if expected and expected.digests[frame.index] != digest:
                raise WorkError(
                    f"{self.name} must be as it was when its run was recorded, but frame {frame.index} differs: record it again"
                )
            self._times_ns.append((frame.left_ns, frame.right_ns))
            yield frame

    def _with_digests(self) -> Iterator[tuple[StereoFrame, str]]:
        """Yield frames with the digest of the recording up to each."""
        digest = hashlib.sha256()
        for frame in self._reader.frames(self.total):
            digest.update(f"{frame.left.shape} {frame.left_ns} {frame.right_ns}\n".encode())
            digest.update(frame.left.tobytes())
            digest.update(frame.right.tobytes())
            yield frame, digest.hexdigest()

    def _unseen(self, known: KnownFrames) -> Iterator[tuple[StereoFrame, str]]:
        """Yield black frames for frames that are stored as before, since nobody looks at their pictures again."""
        black = np.zeros((self._reader.height, 2 * self._reader.width), np.uint8)
        for index, (digest, (left_ns, right_ns)) in enumerate(
            zip(known.digests, known.times_ns, strict=True)
        ):
            yield StereoFrame(index, black, black, left_ns, right_ns, None), digest

    @property
    def known(self) -> KnownFrames:
        """What is known of the frames read so far."""
        end = self._reader.read_end
        return KnownFrames(
            digests=tuple(self.digests),
            times_ns=tuple(self._times_ns),
            stored_end=end,
            stored_digest=self._reader.stored_digest(end),
        )

    def expect(self, known: KnownFrames) -> None:
        """Compare each frame read from now on with what was read before. Raises WorkError if one differs.

        If the file is the same, byte by byte, as far as it was read, the pictures are not unpacked, and are black.
        """
        self._expected = known

    def times_ns(self, index: int) -> dict[str, int]:
        """Return when the pictures of a frame were taken, by camera."""
        return dict(zip(("left", "right"), self._times_ns[index], strict=True))

    @property
    def digest(self) -> str:
        """Digest of the pixels and time stamps read so far."""
        return self.digests[-1] if self.digests else hashlib.sha256().hexdigest()


def recording_digest(recording: Path | str | None, frames: int) -> str:
    """Return the digest of a recording's first `frames` frames, as in a run's identity; "" if it has fewer."""
    with RecordingReader(recording or shipped.RECORDING) as reader:
        source = DigestedFrames(reader, frames)
        return source.digest if sum(1 for _ in source) == frames else ""


def name_of(path: Path) -> str:
    """Return the name of a file as an identity has it."""
    return written(path.name)


def written(path: str | Path) -> str:
    """Return a path or a name as text that can be written, even if it is not valid text."""
    return os.fsencode(path).decode(errors="replace")


def identity_of(setup: RunSetup, fitted: FittedFirmware, recording: str) -> Identity:
    """Return what a run of a recording of that name depends on; its digest comes when its frames have been read."""
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
