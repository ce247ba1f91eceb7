"""How rarely Python looks for garbage."""

from __future__ import annotations

import gc

import pytest

from bfsim.__main__ import main
from bfsim.process.garbage import COLLECT_AFTER, collect_no_more, rarely_collected


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


def test_what_a_command_leaves_is_not_looked_through() -> None:
    """All that there is at its end."""
    try:
        collect_no_more()
        assert gc.get_freeze_count() > 10_000
        assert len(gc.get_objects()) < 1000
    finally:
        gc.unfreeze()


def test_a_command_ends_without_a_look(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever it was asked for."""
    looked = []
    monkeypatch.setattr("sys.argv", ["bfsim", "--version"])
    monkeypatch.setattr("bfsim.process.garbage.collect_no_more", lambda: looked.append(False))
    monkeypatch.setattr("bfsim.process.signals.hear_signals", lambda: None)
    with rarely_collected(), pytest.raises(SystemExit):
        main()
    assert looked == [False]
    assert capsys.readouterr().out.startswith("bfsim")
