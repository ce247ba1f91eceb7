"""Checks of indexes and divisors cost the robot nothing."""

from __future__ import annotations

from typing import Any

import pytest

from bfsim.kernel import Kernel
from bfsim.machine_code import Effort
from bfsim.run import simulate

FRAMES = 2


@pytest.mark.exhaustive
def test_checks_change_no_cycle_of_the_firmware(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two frames of the built-in recording have the same records with and without checks: cycles, results and messages."""
    checked = simulate(frames=FRAMES, profile="vdsp-O2")
    compiled, asked = Kernel.compile, []

    def unchecked(self: Kernel, *given: Any, **how: Any) -> Any:
        asked.append(self.name)
        return compiled(self, *given, **{**how, "checked": False, "effort": Effort.NONE})

    monkeypatch.setattr(Kernel, "compile", unchecked)
    assert simulate(frames=FRAMES, profile="vdsp-O2") == checked
    assert "sobel_row" in asked
