"""The baseline file and the sentences in it: every mistake is told with its place."""

from __future__ import annotations

import shlex
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bfsim.errors import ConfigError
from bfsim.report.check.baseline import Case
from bfsim.report.check.baseline_file import read_baseline, update_command
from bfsim.report.check.figures import COUNTS, MEMORY, OF_THE_RUN, Figure, Unit
from bfsim.report.check.requirement import counts_text, limit_text
from bfsim.report.check.requirement_reading import parse_requirement
from bfsim.report.check.update import write_cases
from bfsim.trace import NO_STAGES


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "must begin with a name"),
        ("frame_rate", "after the name must come <=, >= or =="),
        ("frame_rate > 15 Hz", "after the name must come <=, >= or =="),
        ("frame_rate >= fast", "after >= must come a number that is not negative"),
        ("latency <= -1 ms", "after <= must come a number that is not negative"),
        ("frame_rate >= 15 fps", "the unit of frame_rate must be Hz, not 'fps'"),
        ("framerate >= 15 Hz", "the unit of the stage framerate must be cycles or s or ms or us, not 'Hz'; did you mean frame_rate?"),
        ("latency <= 1e999 ms", "after <= must come a number written out, such as 12_000 or 0.25"),
        ("latency <= 1,5 ms", "after <= must come a number written out"),
        ("latency <= 200", "the unit of latency must be cycles or s or ms or us, not ''"),
        ('"Edge detection".max <= 80 sec', "the unit of the stage Edge detection must be cycles or s or ms or us, not 'sec'"),
        ("memory.L2 <= 100 kB", "the unit of memory.L2 must be B or KB or MB or %, not 'kB'"),
        ("missed == -1", "after == must come a number that is not negative"),
        ("objects.ball == 0 -1", "after == must come a number that is not negative"),
        ("results.drift <= -", "after <= must come a number"),
        ("missed == 0 frames", "the unit of missed must be none, not 'frames'"),
        ("memory <= 1 KB", "memory must be followed by a name"),
        ("results >= 1", "results must be followed by a name"),
        ("frame.average <= 1 ms", "frame must be followed by min, median, max or total, or nothing"),
        ("results.balls >= 1 2", "a number for each frame must come after =="),
        ("Edge.A.mean <= 1 ms", "Edge.A must be followed by min, median, max or total"),
        ("a..b <= 1 ms", "must begin with a name"),
    ],
)  # fmt: skip
def test_a_wrong_sentence_has_a_caret_under_what_is_wrong(text: str, message: str) -> None:
    """The message begins with where it stands."""
    with pytest.raises(ConfigError, match="(?s)^bfsim.toml: ") as caught:
        parse_requirement(text, "bfsim.toml")
    told, shown, caret = str(caught.value).split("\n")
    assert message in told
    assert shown.strip() == text
    assert caret.strip() == "^"


def test_the_caret_is_under_the_unit() -> None:
    """Not at its begin, where everything was right."""
    with pytest.raises(ConfigError) as caught:
        parse_requirement("frame_rate >= 15 fps", "f")
    _, shown, caret = str(caught.value).split("\n")
    assert shown[caret.index("^") :] == "fps"


@given(st.integers(0, 10**12), st.sampled_from([400e6, 500e6, 600e6, 750e6, 1e9]))
def test_a_limit_in_ms_says_every_cycle(cclk: int, cclk_hz: float) -> None:
    """A run always keeps the limits that it set."""
    figure = Figure(values=(cclk,), unit=Unit.CCLK)
    written = parse_requirement(limit_text(("Edge", "A"), cclk, cclk_hz, "max"), "f")
    assert written.limit(figure, cclk_hz) == cclk


@given(st.floats(0.001, 10**5))
def test_a_frame_rate_keeps_its_own_limit(hz: float) -> None:
    """What is written is never more than what was measured."""
    figure = Figure(values=(hz,), unit=Unit.HZ)
    assert hz - 1e-6 <= parse_requirement(limit_text(("frame_rate",), hz, 1e6), "f").limit(figure, 1e6) <= hz


@given(st.lists(st.integers(-(10**6), 10**6), min_size=1, max_size=40))
def test_counts_are_read_as_they_were_written(values: list[int]) -> None:
    """Repeated ones are written once."""
    assert parse_requirement(counts_text(("results", "a b"), values), "f").numbers == tuple(
        map(Fraction, values)
    )


@given(st.text(max_size=40))
def test_whatever_is_written_is_read_or_refused(text: str) -> None:
    """Nothing else comes out."""
    try:
        parse_requirement(text, "f")
    except ConfigError:
        return


def refusal(tmp_path: Path, text: str) -> str:
    """What is said of a file."""
    path = tmp_path / "bfsim.toml"
    path.write_text(text)
    with pytest.raises(ConfigError) as caught:
        read_baseline(path)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[[run]", "must be TOML: "),
        ("[[run]]\nframes = 2", "run 1, the key name must be there"),
        ("[[run]]\nname = 'a'\nframes = 0", "run 'a', frames must be greater than or equal to 1, not 0"),
        ("[[run]]\nname = 'a'\ntolerance_percent = -1", "tolerance_percent must be greater than or equal to 0, not -1"),
        ("[[run]]\nname = 'a'\ntolerance_percent = nan", "tolerance_percent must be a finite number, not nan"),
        ("[[run]]\nname = 'a'\nplank = 'x'", "run 'a', plank must not be there; known keys are recording, "),
        ("[[run]]\nname = 'a'\nfeed = 'fast'", "feed must be 'demand', 'recorded' or 'cameras', not 'fast'"),
        ("[[run]]\nname = 'a'\n[[run]]\nname = 'a'", "each run must have a name of its own, but two are called 'a'"),
        ("[[run]]\nname = 'a'\nrequire = ['fps > 1']", "run 'a', require: after the name"),
        ("runs = 1", "runs must not be there; known keys are run"),
        ("axes.ldf = ['l2']", "must be a baseline of `bfsim check`, not a file of `bfsim sweep`"),
        ("[[point]]\nldf = 'l2'", "not a file of `bfsim sweep`; points of that are compared by what would stand behind `bfsim run`"),
        ("run = 1", "run must be a valid list, not 1"),
        ("run = [1]", "run 1, it must be a valid dictionary, not 1"),
        ("[[run]]\nname = ''", "name must have at least 1 character, not ''"),
        ("[[run]]\nname = 'a'\ncosts.of = [{x = 1}]", "run 'a', the key costs.frames must be there; --update writes costs anew once it is removed"),
        ("[[run]]\nname = 'a'\ncosts = {frames = 1, frame_ms = 1.0, cclk_hz = 1.0, least_cclk = 1, of = [{stage = 'a', owner = 'b', cclk = 1, x = 1}]}",
         "costs.of.0.x must not be there; known keys are stage, owner, symbol, place, cclk, lines; --update writes"),
        (f"[[run]]\nname = 'a'\ncosts = {{frames = {10**12}, frame_ms = 1.0, cclk_hz = 1.0, least_cclk = {10**400}}}", "costs.frames must be less than"),
        (f"[[run]]\nname = 'a'\ncosts = {{frames = 1, frame_ms = 1.0, cclk_hz = 1.0, least_cclk = {10**400}}}", "costs.least_cclk must be less than 9223"),
        ("[[run]]\nname = 'a'\nmeasured_on = 3", "measured_on must be a valid dictionary, not 3; --update writes measured_on anew"),
        (f"[[run]]\nname = 'a'\nrequire = ['latency <= {'9' * 5000} ms']", "after <= must come numbers of at most 30 digits"),
        ("[[run]]\nname = 'a'\nrequire = ['results.x == 1*999999 2*999999']", "after == must come counts of at most 1,000,000 frames"),
        ("tolerance_percent = 0\n[measured_on]\nx = 1", "older bfsim, and must be made anew"),
    ],
)  # fmt: skip
def test_faulty_file_names_run_and_key(tmp_path: Path, text: str, message: str) -> None:
    """Every mistake in the file is told with the file, the run and what must be there."""
    told = refusal(tmp_path, text)
    assert told.startswith(str(tmp_path / "bfsim.toml"))
    assert message in told


def test_the_command_that_updates_is_one_that_a_shell_takes() -> None:
    """With spaces, quotes and dollars in names of files and runs."""
    words = shlex.split(update_command(Path("my limits.toml"), 'the "drive" to Joe\'s $5'))
    assert words == [
        "bfsim",
        "check",
        "--baseline",
        "my limits.toml",
        "--case",
        'the "drive" to Joe\'s $5',
        "--update",
    ]


def test_a_file_of_windows_is_read(tmp_path: Path) -> None:
    """With its mark at the beginning."""
    (tmp_path / "bfsim.toml").write_text("[[run]]\nname = 'a'\n", encoding="utf-8-sig")
    assert [case.name for case in read_baseline(tmp_path / "bfsim.toml").run] == ["a"]


def test_numbers_are_written_as_in_a_sweep(tmp_path: Path) -> None:
    """In tables or by paths, as numbers or as text: the board is the same, and the file stays as it is written."""
    path = tmp_path / "bfsim.toml"
    told = []
    for text in (
        """set = {"sdram.nRP" = "3", "clocks.cclk_hz" = "500000000"}\ndefine = {ROWS = "2"}""",
        """set.sdram.nRP = 3\nset.clocks.cclk_hz = 500e6\ndefine.ROWS = 2""",
        """[run.set.sdram]\nnRP = 3\n[run.set]\nclocks.cclk_hz = 500e6\n[run.define]\nROWS = 2""",
    ):
        path.write_text(f"[[run]]\nname = 'a'\n{text}\n")
        (case,) = read_baseline(path).run
        told.append((case.set, case.define))
        write_cases(path, {"a": case})
        assert path.read_text() == f"[[run]]\nname = 'a'\n{text}\n"
    assert told == [({"sdram.nRP": "3", "clocks.cclk_hz": "500000000"}, {"ROWS": "2"})] * 3
    path.write_text("[[run]]\nname = 'a'\nset.sdram.nRP = [3]\n")
    assert "run 'a', set.sdram.nRP must be a valid string, not [3]" in refusal(tmp_path, path.read_text())


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_lines_end_as_they_did(tmp_path: Path, end: str) -> None:
    """Those that are written, too; the lists of limits have lines of their own."""
    path = tmp_path / "bfsim.toml"
    path.write_bytes(f"# mine{end}[[run]]{end}name = 'a'{end}".encode())
    limits = ["missed == 0", "frame_rate >= 1 Hz"]
    write_cases(path, {"a": Case(name="a", limits=limits), "b": Case(name="b")})
    written = path.read_bytes().decode()
    assert written.count("\n") == written.count(end) > 8
    assert written.startswith(f"# mine{end}")
    assert read_baseline(path).run[0].limits == limits


def test_missing_file_is_told_how_to_make_one(tmp_path: Path) -> None:
    """The first check of a new repository."""
    with pytest.raises(
        ConfigError, match=r"none\.toml must be a baseline file, but there is none: .* --update"
    ):
        read_baseline(tmp_path / "none.toml")


def test_no_stage_is_called_like_another_figure() -> None:
    """Cycles of a stage `memory` were limits in bytes, those of `results` had to be the same to the cycle, and `frame` could not be kept."""
    assert {MEMORY, *COUNTS, *(name for (name,) in OF_THE_RUN)} == NO_STAGES
