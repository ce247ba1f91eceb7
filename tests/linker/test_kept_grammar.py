"""The parser of LDFs is made once and kept in the cache: what is kept reads and refuses as what is made."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from lark import Lark

from bfsim import shipped
from bfsim.errors import BfsimWarning, LinkError
from bfsim.linker import grammar, parse_ldf, parser


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[list[str]]:
    """Note each parser that is made from now on, with an empty cache."""
    found: list[str] = []
    real = Lark.__init__

    def noted(self: Lark, text: str, **options: object) -> None:
        found.append(text)
        real(self, text, **options)

    monkeypatch.setattr(Lark, "__init__", noted)
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path / "cache"))
    yield found
    grammar._grammar.cache_clear()


def told_of(ldf: Path) -> str:
    """What a new process makes of an LDF, or says against it."""
    grammar._grammar.cache_clear()
    parser._script.cache_clear()
    try:
        return repr(parse_ldf(ldf))
    except LinkError as error:
        return str(error)


def test_the_second_start_makes_none(made: list[str], tmp_path: Path) -> None:
    """Shipped files and wrong ones: every start says the same, and only the first one makes a parser."""
    ldfs = sorted(shipped.LDF_FOLDER.glob("*.ldf"))
    for number, text in enumerate(("MEMORY {", "#if (1 + 2\n#endif", "ARCHITECTURE(ADSP-BF561)\nx = = 3;")):
        ldfs.append(tmp_path / f"wrong{number}.ldf")
        ldfs[-1].write_text(text)
    first = [told_of(ldf) for ldf in ldfs]
    assert len(ldfs) > 3
    assert len(made) == 1
    assert [told_of(ldf) for ldf in ldfs] == first
    assert len(made) == 1


def test_where_nothing_can_be_kept_each_start_makes_one(
    made: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A folder that others can write to is never unpickled from."""
    (tmp_path / "open").mkdir()
    (tmp_path / "open").chmod(0o777)
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path / "open"))
    ldf = min(shipped.LDF_FOLDER.glob("*.ldf"))
    with pytest.warns(BfsimWarning, match="must be private"):
        told_of(ldf)
    told_of(ldf)
    assert len(made) == 2
    assert not list((tmp_path / "open").iterdir())
