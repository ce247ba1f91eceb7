"""Object code checks no index, so code that nobody has tried runs as it is written first, for a frame."""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.errors import KernelError
from bfsim.kernel import VDSP_O2
from bfsim.kernel.build import Build
from bfsim.running import setup
from tests.eyes import FIRMWARE, record, run_eyes

CHANGES = (
    ("out: u8[:])", "out: u8[:], ahead: i32)"),
    ("    counts[0] += found\n", "    unused = line[ahead]\n    counts[0] += found\n"),
    ("target)\n", "target, 64 * (frames == WRONG))\n"),
    ("        core.publish", "        frames += 1\n        core.publish"),
    ("    while", "    frames = 0\n    while"),
)


def write(folder: Path, wrong: int) -> Path:
    """Write firmware that loads behind its line in a frame, of which the compiler leaves nothing. Return a recording for it."""
    text = FIRMWARE
    for before, after in CHANGES:
        assert before in text
        text = text.replace(before, after.replace("WRONG", str(wrong)), 1)
    (folder / "fw_eyes.py").write_text(text)
    return record(folder / "drive.mcap", 3)


@pytest.fixture
def untried(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Kernels count as object code that was compiled just now."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(setup, "build_for", lambda _loaded, _profile: Build(VDSP_O2, is_tried=False))


@pytest.mark.usefixtures("untried")
def test_the_first_frame_is_checked(tmp_path: Path) -> None:
    """With kernel, line and frame."""
    with pytest.raises(KernelError, match=r"index 64 is outside of line in kernel threshold(.|\n)*frame 0"):
        run_eyes(write(tmp_path, 0))


@pytest.mark.usefixtures("untried")
def test_later_ones_are_if_asked(tmp_path: Path) -> None:
    """As slow as it is."""
    recording = write(tmp_path, 2)
    assert len(run_eyes(recording).frames) == 3
    with pytest.raises(KernelError, match=r"index 64 is outside of line in kernel threshold(.|\n)*frame 2"):
        run_eyes(recording, sanitize=True)
