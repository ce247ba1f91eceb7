"""The README is true: its firmware runs, its commands exist, and its budget is what `bfsim run` prints."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

README = (Path(__file__).parent.parent / "README.md").read_text()


def bfsim(*arguments: str, cwd: Path | None = None) -> str:
    """Run the command line, which must succeed, and return what it printed."""
    command = [sys.executable, "-m", "bfsim", *arguments]
    environment = {**os.environ, "COLUMNS": "80"}
    result = subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return result.stdout


def test_the_firmware_of_the_readme_runs(tmp_path: Path) -> None:
    """The example can be pasted into a file and run beside it."""
    (example,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    (tmp_path / "brightness.py").write_text(example)
    report = bfsim("run", "--firmware", "brightness:firmware", "--frames", "2", cwd=tmp_path)
    assert "Brightness" in report
    assert "brightness_A" in report


def test_the_budget_of_the_readme_is_what_run_prints() -> None:
    """The sample output is the real one, line by line."""
    printed = {line.rstrip() for line in bfsim("run").splitlines()}
    sample = README.split("<!-- budget -->\n")[1].split("\n\nfollowed by")[0]
    for line in sample.splitlines():
        assert line.removeprefix("    ").rstrip() in printed


def test_the_commands_of_the_readme_exist() -> None:
    """Every command and option that the README names has a help text with it."""
    helps = {
        name: bfsim(*name.split(), "--help")
        for name in (
            "run",
            "profile",
            "explain",
            "check",
            "record import",
            "record info",
            "record render",
            "record calibrate",
            "ldf",
            "boards",
        )
    }
    for name in helps:
        assert f"`bfsim {name}" in README
    of_others = {"--help", "--recording"}  # the latter is an option of the tests
    for option in set(re.findall(r"--[a-z]+", README)) - of_others:
        assert any(option in text for text in helps.values()), option


def test_the_files_of_the_readme_exist() -> None:
    """Every file and folder of the repository that the README names in code is there."""
    root = Path(__file__).parent.parent
    in_code = " ".join(re.findall(r"`([^`\n]+)`", README)).split()
    named = {word for word in in_code if re.match(r"(bfsim|firmware|benchmarks|tests|ldf)/", word)}
    named |= {f"benchmarks/{word}" for word in in_code if re.fullmatch(r"\w+_\w+\.py", word)}
    assert len(named) > 20
    assert not [each for each in named if each != "benchmarks/..." and not (root / each).exists()]


def test_the_readme_is_short() -> None:
    """Lines fit 120 columns, and there are not many of them."""
    lines = README.splitlines()
    assert max(map(len, lines)) <= 120
    assert len(lines) <= 275
