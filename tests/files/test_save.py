"""Files are written whole or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.errors import ConfigError
from bfsim.files.save import require_apart, require_place, write_text
from bfsim.report.overlay.files import OverlayWriter


def test_file_is_replaced_and_nothing_is_left_beside_it(tmp_path: Path) -> None:
    """The old text goes, permissions stay, no temporary file remains."""
    path = tmp_path / "report.json"
    path.write_text("old and longer")
    path.chmod(0o640)
    write_text(path, "new")
    assert path.read_text() == "new"
    assert path.stat().st_mode & 0o777 == 0o640
    assert list(tmp_path.iterdir()) == [path]


def test_link_is_followed(tmp_path: Path) -> None:
    """A link to the file stays a link."""
    target, link = tmp_path / "target", tmp_path / "link"
    target.write_text("old")
    link.symlink_to(target)
    write_text(link, "new")
    assert link.is_symlink()
    assert target.read_text() == "new"


def test_missing_folder_is_refused(tmp_path: Path) -> None:
    """Folders are not made up on the way."""
    with pytest.raises(ConfigError, match=r"the folder .*reports must exist"):
        write_text(tmp_path / "reports" / "run.json", "new")


def test_a_folder_that_cannot_be_written_is_told_before_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The tests may run as root, who can write everywhere; so the system's answer is made up."""
    monkeypatch.setattr("bfsim.files.save.os.access", lambda path, mode: False)
    with pytest.raises(ConfigError, match=r"the folder .* must be writable to write a file there"):
        require_place(tmp_path / "run.json")


def test_folder_and_device_are_refused(tmp_path: Path) -> None:
    """Replacing a device node by a file would break the system for everyone."""
    for path in (tmp_path, Path("/dev/null")):
        with pytest.raises(ConfigError, match="must be an ordinary file"):
            write_text(path, "new")


def test_standard_output_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file or a folder called - would be in the way of every later command."""
    monkeypatch.chdir(tmp_path)
    for refused in (require_place, OverlayWriter):
        with pytest.raises(ConfigError, match="- must be the name of a file, not standard output"):
            refused(Path("-"))


def test_links_in_a_circle(tmp_path: Path) -> None:
    """They lead nowhere."""
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    with pytest.raises(ConfigError, match="loop must lead to a place, not in a circle of links"):
        require_place(loop)
    with pytest.raises(ConfigError, match="in a circle"):
        require_apart(tmp_path / "other", [loop])
