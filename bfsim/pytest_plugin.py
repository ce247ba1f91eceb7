"""The pytest plugin: the fixtures `bfsim`, which runs firmware, and `bfsim_check`; the marker `frame_budget`.

Nothing is imported until a test asks for the fixture.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from bfsim.report.check.verdicts import Outcome
    from bfsim.report.results.result import Result
    from bfsim.result import Run
    from bfsim.seen import SeenFrame

MARK = "frame_budget"

_RUNS = pytest.StashKey[dict[str, "Result"]]()
_IS_HELD = pytest.StashKey[bool]()
"""Whether a run of the test was compared with its marker."""


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker."""
    config.addinivalue_line(
        "markers",
        f"{MARK}(*require, min_hz=None, stages={{}}): limits for the runs of the fixture `bfsim`: sentences of `bfsim check` "
        'such as "latency <= 200 ms", the least frame rate in Hz, and the most ms of stages in any frame',
    )
    config.stash[_RUNS] = {}


@pytest.hookimpl(wrapper=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> Generator[None, object, object]:
    """Fail a test with its own marker that ran no firmware: nothing was compared with its limits."""
    result = yield
    if any(each.name == MARK for each in pyfuncitem.own_markers) and _IS_HELD not in pyfuncitem.stash:
        pytest.fail(
            f"@pytest.mark.{MARK} must be of a test that runs firmware by the fixture `bfsim`; this one ran none",
            pytrace=False,
        )
    return result


@pytest.fixture
def bfsim(request: pytest.FixtureRequest) -> Callable[..., Run]:
    """Return `bfsim.run.simulate`, but it runs each configuration once a session, and checks the test's `frame_budget`."""
    from bfsim.errors import BfsimError
    from bfsim.result import Run

    with _mistakes():
        required = [each for mark in request.node.iter_markers(MARK) for each in _sentences(mark)]

    def run(*recording: Any, **what: Any) -> Run:
        __tracebackhide__ = True
        try:
            result = _once(request.config, *recording, **what)
        except BfsimError as error:
            raise error.with_traceback(_firmware_alone(error.__traceback__)) from _cause(error)
        with _mistakes():
            broken = _broken(result, required)
        request.node.stash[_IS_HELD] = True
        if broken:
            pytest.fail(broken, pytrace=False)
        assert isinstance(result.run, Run)
        return result.run

    return run


@pytest.fixture
def bfsim_check(request: pytest.FixtureRequest) -> Callable[..., dict[str, Run]]:
    """Return a function that does what `bfsim check` does and fails the test if a run breaks its limits.

    Call it as `bfsim_check("budget.toml", case=None)`; the file lies beside the test. It returns the runs by name: all
    of the file, or the one named.
    """
    from bfsim.checking import arguments_of, require_comparable, require_held
    from bfsim.report.check.baseline_file import read_baseline
    from bfsim.report.check.choice import chosen
    from bfsim.report.check.judge import judge
    from bfsim.report.check.sentences import verdict_line
    from bfsim.result import Run

    def check(baseline: str = "budget.toml", case: str | None = None) -> dict[str, Run]:
        path = request.path.parent / baseline
        with _mistakes():
            cases = chosen(read_baseline(path), path, None, case, "", update=False)
            for each in cases:
                require_comparable(each, path)
                require_held(each, path)
            results = {
                each.name: _once(request.config, **arguments_of(each.configuration, path.parent))
                for each in cases
            }
            outcomes = [judge(each, results[each.name], path) for each in cases]
        told = [f"{verdict_line(each)}\n{_told(each)}" for each in outcomes if not each.passed]
        if told:
            pytest.fail("\n\n".join(told), pytrace=False)
        return {name: each.run for name, each in results.items() if isinstance(each.run, Run)}

    return check


def _once(config: pytest.Config, *recording: Any, **what: Any) -> Result:
    """Run firmware, or return the run of the same configuration that this session has done."""
    __tracebackhide__ = True
    from bfsim.errors import ConfigError

    runs = config.stash[_RUNS]
    key = f"{Path.cwd()} {recording} {sorted(what.items(), key=lambda each: each[0])}"
    if key not in runs:
        runs[key] = _result(*recording, **what)
    if not runs[key].run.frames:
        raise ConfigError("a run must have at least one frame to hold against a budget")
    return runs[key]


def _result(*recording: Any, on_seen: Callable[[SeenFrame], None] | None = None, **what: Any) -> Result:
    """Run firmware, and note the names of what it sees."""
    __tracebackhide__ = True
    from bfsim.report.results.result import result_of
    from bfsim.run import simulate

    seen: dict[int, dict[str, Any]] = {}

    def note(frame: SeenFrame) -> None:
        seen[frame.index] = {"objects": [asdict(each) for each in frame.objects]}
        if on_seen:
            on_seen(frame)

    return result_of(simulate(*recording, on_seen=note, **what), seen)


@contextmanager
def _mistakes() -> Iterator[None]:
    """Fail the test with the mistake in its marker or baseline, without the code that found it."""
    from bfsim.errors import BfsimError

    try:
        yield
    except BfsimError as error:
        raise pytest.fail.Exception(str(error), pytrace=False) from None


def _cause(error: BaseException) -> BaseException | None:
    """Return the error that the firmware itself raised, if any, without the calling code."""
    from bfsim.errors import BfsimError

    cause = error.__cause__
    while isinstance(cause, BfsimError):  # simpy raises the same one again
        cause = cause.__cause__
    return cause and cause.with_traceback(_firmware_alone(cause.__traceback__))


def _firmware_alone(calls: TracebackType | None) -> TracebackType | None:
    """Return a traceback with the firmware's own part only."""
    from bfsim.machine.firmware_lines import INSTALLED, is_firmware

    if calls is None:
        return None
    inner, file = _firmware_alone(calls.tb_next), calls.tb_frame.f_code.co_filename
    is_own = is_firmware(file) and INSTALLED.isdisjoint(Path(file).parts)
    return TracebackType(inner, calls.tb_frame, calls.tb_lasti, calls.tb_lineno) if is_own else inner


def _sentences(mark: pytest.Mark) -> list[str]:
    """Return what a marker says as sentences of `bfsim check`; raise ConfigError for anything not allowed."""
    from bfsim.errors import ConfigError, cut, shown

    for each in mark.args:
        if not isinstance(each, str):
            raise ConfigError(
                f'@pytest.mark.{MARK}: a limit must be a sentence such as "latency <= 200 ms", not {shown(each)}'
            )
    unknown = [each for each in mark.kwargs if each not in {"min_hz", "stages"}]
    if unknown:
        raise ConfigError(f"@pytest.mark.{MARK}: {cut(unknown[0])} must be min_hz or stages")
    min_hz, stages = mark.kwargs.get("min_hz"), mark.kwargs.get("stages") or {}
    if not isinstance(stages, Mapping):
        raise ConfigError(
            f"@pytest.mark.{MARK}: stages must be a table: the most milliseconds of each, by name"
        )
    rate = [] if min_hz is None else [f"frame_rate >= {_number(min_hz, 'min_hz')} Hz"]
    most = [f'"{stage}".max <= {_number(ms, "stages")} ms' for stage, ms in stages.items()]
    sentences = [*mark.args, *rate, *most]
    if not sentences:
        raise ConfigError(f"@pytest.mark.{MARK} must say a limit, min_hz or stages, for nothing breaks it")
    return sentences


def _number(value: object, what: str) -> str:
    """Return a number in the form for a sentence; raise ConfigError for anything else."""
    from bfsim.errors import ConfigError, shown

    with suppress(OverflowError):  # an integer beyond all floats
        if isinstance(value, int | float) and not isinstance(value, bool):
            return f"{value:f}"
    raise ConfigError(f"@pytest.mark.{MARK}: {what} must be a number, not {shown(value)}")


def _broken(result: Result, required: list[str]) -> str:
    """Return the limits that a run breaks, and the dearest kernels and lines; "" if it breaks none."""
    from bfsim.report.check.baseline import Case
    from bfsim.report.check.judge import judge

    case = Case(name=result.run.identity.firmware, require=required)
    return _told(judge(case, result, Path(f"@pytest.mark.{MARK}")))


def _told(outcome: Outcome) -> str:
    """Return the broken limits, and why; "" if there are none."""
    from bfsim.report.check.cause import explanation
    from bfsim.report.check.sentences import broken_lines
    from bfsim.result import Run

    if outcome.passed:
        return ""
    assert isinstance(outcome.run, Run)
    return "\n".join([*broken_lines(outcome), "", *explanation(outcome), "", outcome.run.report()])
