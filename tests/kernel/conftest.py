"""Kernels for the tests of bfsim.kernel: written as text, kept in a file, imported like any module."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import pytest

from tests.kernel.modules import import_text

ImportText = Callable[[str], ModuleType]


@pytest.fixture(scope="session", autouse=True)
def cache_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Keep compiled kernels in a folder of this test run: every run starts cold."""
    folder = tmp_path_factory.mktemp("kernels")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("BFSIM_CACHE_DIR", str(folder))
        yield folder


@pytest.fixture
def import_kernels(tmp_path: Path) -> ImportText:
    """Import a module of kernels from its text."""
    return lambda text: import_text(text, tmp_path)
