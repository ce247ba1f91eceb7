"""Kernels for the tests of bfsim.kernel: written as text, kept in a file, imported like any module."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from tests.kernel.modules import import_text

ImportText = Callable[[str], ModuleType]


@pytest.fixture
def import_kernels(tmp_path: Path) -> ImportText:
    """Import a module of kernels from its text."""
    return lambda text: import_text(text, tmp_path)
