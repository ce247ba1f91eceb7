"""What a run depends on, as names and digests."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

import llvmlite.binding as llvm

from bfsim import __version__
from bfsim.loading.firmware import compilers_of
from bfsim.running.setup import FittedFirmware, RunSetup
from bfsim.trace import Identity


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
