"""Drafts: nothing is left beside an output, however its process ended."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from bfsim.files.drafts import draft_folder, sweep

KILLED = """
import os, signal, sys
from pathlib import Path
from bfsim.files.drafts import draft_folder
with draft_folder(Path(sys.argv[1])) as folder:
    (folder / "half").write_text("written")
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_nothing_is_left_after_a_failure(tmp_path: Path) -> None:
    """The folder goes away with what was in it."""
    with pytest.raises(ValueError, match="no more"), draft_folder(tmp_path) as folder:
        (folder / "half").touch()
        raise ValueError("no more")
    assert not list(tmp_path.iterdir())


def test_what_a_killed_process_left_is_swept_by_the_next(tmp_path: Path) -> None:
    """Nobody could tidy up, so who comes next does."""
    subprocess.run([sys.executable, "-c", KILLED, str(tmp_path)], check=False)
    assert [each.name for left in tmp_path.iterdir() for each in left.iterdir()] == ["half"]
    with draft_folder(tmp_path) as folder:
        assert list(tmp_path.iterdir()) == [folder]


def test_the_draft_of_a_living_process_stays(tmp_path: Path) -> None:
    """Two runs may write into one folder at once."""
    with draft_folder(tmp_path) as folder:
        program = "import sys; from pathlib import Path; from bfsim.files.drafts import sweep; sweep(Path(sys.argv[1]))"
        subprocess.run([sys.executable, "-c", program, str(tmp_path)], check=True)
        assert folder.is_dir()


def test_only_drafts_are_swept(tmp_path: Path) -> None:
    """Another's folder stays, and so does what a link points to."""
    kept = [tmp_path / name for name in (".bfsim-notes", ".bfsim-abcdefgh.draft.txt", "bfsim-abcdefgh.draft")]
    for each in kept:
        each.mkdir()
    link = tmp_path / ".bfsim-abcdefgh.draft"
    link.symlink_to(kept[0])
    sweep(tmp_path)
    assert set(tmp_path.iterdir()) == {*kept, link}


@pytest.mark.skipif(os.geteuid() == 0, reason="nothing is forbidden to root")
def test_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    """The system's refusal comes through."""
    tmp_path.chmod(0o500)
    with pytest.raises(PermissionError), draft_folder(tmp_path):
        pass
