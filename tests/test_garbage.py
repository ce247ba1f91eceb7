"""How rarely Python looks for garbage."""

from __future__ import annotations

import gc

import pytest

from bfsim.garbage import COLLECT_AFTER, rarely_collected


def test_python_looks_rarely_for_as_long_as_a_run_and_then_as_before() -> None:
    """Whatever ends it."""
    outside = gc.get_threshold()
    gc.set_threshold(123, 4, 5)
    try:
        with pytest.raises(KeyboardInterrupt), rarely_collected():
            assert gc.get_threshold() == (COLLECT_AFTER, 4, 5)
            raise KeyboardInterrupt
        assert gc.get_threshold() == (123, 4, 5)
    finally:
        gc.set_threshold(*outside)
