"""Small LDFs for the linker's tests: each test writes the one it needs."""

from __future__ import annotations

from pathlib import Path

import pytest

from bfsim.linker import LinkerScript, parse_ldf
from tests.linker.small_ldfs import Parse


@pytest.fixture
def parse(tmp_path: Path) -> Parse:
    """Parse the text of an LDF as the file test.ldf."""

    def parse_text(text: str) -> LinkerScript:
        path = tmp_path / "test.ldf"
        path.write_text(text)
        return parse_ldf(path)

    return parse_text
