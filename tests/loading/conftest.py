"""What loading firmware leaves behind in Python: nothing."""

from __future__ import annotations

import sys
from collections.abc import Iterator

import pytest


@pytest.fixture(autouse=True)
def untouched() -> Iterator[None]:
    """Whatever is loaded, Python's path and modules are afterwards as they were."""
    path, modules, finders = sys.path[:], dict(sys.modules), sys.meta_path[:]
    yield
    assert (sys.path, sys.meta_path) == (path, finders)
    new = {name for name, module in sys.modules.items() if modules.get(name) is not module}
    assert not {name for name in new if name.startswith(("fw_", "tinyphoon"))}
