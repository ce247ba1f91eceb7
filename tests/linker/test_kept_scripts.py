"""LDFs that were read before are taken from the cache: they are what reading them again would be."""

from __future__ import annotations

from pathlib import Path
from typing import NoReturn

import pytest

from bfsim import shipped
from bfsim.errors import LinkError
from bfsim.linker import LinkerScript, parse_ldf, parser
from bfsim.linker.kept_scripts import kept_script
from bfsim.linker.preprocessor import preprocess

MACROS = {"SDRAM_BANK_BYTES": "0x2000000"}


def read(path: Path) -> LinkerScript:
    """Read an LDF as a process does that has just started."""
    parser._script.cache_clear()
    return parse_ldf(path, MACROS, [shipped.LDF_FOLDER])


def refused(_: object) -> NoReturn:
    """Stand in for what reads an LDF."""
    raise AssertionError("an LDF is read that is kept")


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path / "cache"))


@pytest.mark.parametrize("name", shipped.LDFS)
def test_another_start_finds_what_was_read(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """All of it: segments, sections, reserves, symbols with their expressions, and the line of each."""
    path = shipped.ldf_at(Path(name))
    assert path
    made = parser._made(preprocess(path, MACROS, [shipped.LDF_FOLDER], ""))
    assert read(path) == made
    monkeypatch.setattr(parser, "_made", refused)
    found = read(path)
    assert found == made
    assert [each.place for each in found.segments] == [each.place for each in made.segments]


def test_another_text_or_place_is_read_again(tmp_path: Path) -> None:
    """A line more moves the statements behind it; a copy elsewhere has its own file in what is said of it."""
    text = "MEMORY { MEM { TYPE(RAM) START(0) LENGTH(1K) WIDTH(8) } }\n"
    one, other = tmp_path / "one.ldf", tmp_path / "other.ldf"
    one.write_text(text)
    other.write_text(text)
    (segment,) = read(one).segments
    assert (segment.place.path, segment.line) == (one, 1)
    assert read(other).segments[0].place.path == other
    one.write_text(f"\n{text}")
    assert read(one).segments[0].line == 2


def test_what_is_wrong_is_said_each_time(tmp_path: Path) -> None:
    """Nothing is kept of it."""
    path = tmp_path / "wrong.ldf"
    path.write_text("MEMORY {")
    for _ in range(2):
        with pytest.raises(LinkError, match=r"wrong\.ldf:1"):
            read(path)


def test_an_ldf_is_read_once(tmp_path: Path) -> None:
    """It was read again for each part that is kept: five times, 16 s where an expression had 100,000 terms."""
    path = tmp_path / "one.ldf"
    path.write_text("MEMORY { MEM { TYPE(RAM) START(0) LENGTH(1K) WIDTH(8) } }\n")
    source = preprocess(path, {}, [], "")
    times = iter([parser._made(source)])
    assert kept_script(source, lambda: next(times)).segments
