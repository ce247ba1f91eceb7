"""The pytest plugin: a fixture `bfsim` that runs firmware, and `@pytest.mark.frame_budget` that limits what a frame costs.

Nothing is imported until a test asks for the fixture.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from bfsim.result import Run

MARK = "frame_budget"

_RUNS = pytest.StashKey[dict[str, "Run"]]()


def pytest_configure(config: pytest.Config) -> None:
    """Tell of the marker."""
    config.addinivalue_line(
        "markers",
        f"{MARK}(*require, min_hz=None, stages={{}}): limits for the runs of the fixture `bfsim`: sentences of `bfsim check` "
        'such as "latency <= 200 ms", the least frame rate in Hz, and the most ms of stages in any frame',
    )
    config.stash[_RUNS] = {}


@pytest.fixture
def bfsim(request: pytest.FixtureRequest) -> Callable[..., Run]:
    """Return `bfsim.run.simulate`, which runs the same configuration once a session, and fails the test if a run breaks its `frame_budget`."""
    from bfsim.errors import ConfigError
    from bfsim.run import simulate

    marks = list(request.node.iter_markers(MARK))
    required = [sentence for mark in marks for sentence in _sentences(*mark.args, **mark.kwargs)]
    runs = request.config.stash[_RUNS]

    def run(*recording: Any, **what: Any) -> Run:
        key = f"{recording} {sorted(what.items(), key=lambda each: each[0])}"
        if key not in runs:
            runs[key] = simulate(*recording, **what)
        if not runs[key].frames:
            raise ConfigError("a run must have at least one frame to hold against a budget")
        if broken := _broken(runs[key], required):
            pytest.fail(broken, pytrace=False)
        return runs[key]

    return run


def _sentences(
    *require: str, min_hz: float | None = None, stages: Mapping[str, float] | None = None
) -> list[str]:
    """Return what a marker says as sentences of `bfsim check`."""
    rate = [f"frame_rate >= {min_hz:f} Hz"] if min_hz is not None else []
    return [*require, *rate, *(f'"{stage}".max <= {ms:f} ms' for stage, ms in (stages or {}).items())]


def _broken(run: Run, required: list[str]) -> str:
    """Return what a run breaks, and what bounds it; nothing if it breaks nothing."""
    from bfsim.report.check.baseline import Case
    from bfsim.report.check.judge import judge
    from bfsim.report.check.outputs import broken_lines

    outcome = judge(Case(name=run.identity.firmware, require=required), run, Path(f"@pytest.mark.{MARK}"))
    if outcome.passed:
        return ""
    return "\n".join([*broken_lines(outcome), "", run.report()])
