"""The workflow of "Keep your frame rate" as a script: its steps run as a CI service would, in a repository of their own."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.eyes import FIRMWARE, record
from tests.pages import ROOT, blocks_of
from tests.tiers import exhaustive

FILE = ".github/workflows/frame-rate.yml"
SLOWER = FIRMWARE.replace("        out[x] = 0\n", "        out[x] = x * 7919 // (line[x] + 1)\n")


def written() -> str:
    """The file as the page has it."""
    [text] = [each.text for each in blocks_of(ROOT / "docs" / "how-to" / "check.md") if each.title == FILE]
    return text


def steps() -> Iterator[Mapping[str, Any]]:
    """The steps of the only job; each runs something or uses an action."""
    [job] = yaml.safe_load(written())["jobs"].values()
    for step in job["steps"]:
        assert ("run" in step) != ("uses" in step)
        yield step


@pytest.fixture
def runner(tmp_path: Path) -> Mapping[str, str]:
    """The environment of a runner that has bfsim from here, and a `pip` that notes what it should install."""
    tools = tmp_path / "tools"
    tools.mkdir()
    for name, script in (
        ("bfsim", f'exec {sys.executable} -m bfsim "$@"'),
        ("pip", f'echo "$@" >> {tmp_path}/installed'),
    ):
        (tools / name).write_text(f"#!/bin/sh\n{script}\n")
        (tools / name).chmod(0o755)
    return {
        **os.environ,
        "PATH": f"{tools}:{os.environ['PATH']}",
        "PYTHONPATH": f"{ROOT}:{ROOT / 'firmware'}",
        "GITHUB_STEP_SUMMARY": str(tmp_path / "summary.md"),
    }


def played(folder: Path, environment: Mapping[str, str]) -> int:
    """Run the steps as GitHub's runner does: with bash -eo pipefail, and after a failure only those that always run."""
    worst = 0
    for step in steps():
        if "run" in step and (worst == 0 or step.get("if") == "always()"):
            command = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step["run"]]
            done = subprocess.run(
                command, cwd=folder, env=environment, capture_output=True, text=True, check=False
            )
            assert done.returncode in {0, 1}, done.stderr
            worst = worst or done.returncode
    return worst


@pytest.mark.parametrize(
    ("word", "instead", "said"),
    [
        ("", "", "ok -- validation done"),
        *exhaustive(
            ("runs-on", "runs-in", "'runs-on' is a required property"),
            ("on: [push, pull_request]", "on: [push, pull_requests]", "'pull_requests' is not one of"),
            ("- uses: actions/checkout@v4", "- use: actions/checkout@v4", "under any of the given schemas"),
        ),
    ],
)
def test_the_workflow_is_one_to_github(tmp_path: Path, word: str, instead: str, said: str) -> None:
    """By SchemaStore's schema of its workflows, which refuses a file with a key, an event or a step that there is not."""
    file = tmp_path / "frame-rate.yml"
    file.write_text(written().replace(word, instead) if word else written())
    command = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", "vendor.github-workflows", file]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert said in done.stdout + done.stderr
    assert (done.returncode == 0) == (not word)


@pytest.mark.exhaustive
def test_the_workflow_passes_and_fails_as_it_should(tmp_path: Path, runner: Mapping[str, str]) -> None:
    """Green with the firmware that was measured; red with a slower one, and the summary says why."""
    repository = tmp_path / "repository"
    repository.mkdir()
    (repository / "fw_eyes.py").write_text(FIRMWARE)
    record(repository / "drive.mcap", 2)
    update = [
        "bfsim",
        "check",
        "drive.mcap",
        "--firmware",
        "fw_eyes.py",
        "--baseline",
        "budget.toml",
        "--update",
    ]
    subprocess.run(update, cwd=repository, env=runner, check=True, capture_output=True)
    assert played(repository, runner) == 0
    assert (tmp_path / "installed").read_text() == "install bfsim\n"
    (repository / "fw_eyes.py").write_text(SLOWER)
    assert played(repository, runner) == 1
    passed, _, failed = (tmp_path / "summary.md").read_text().partition("❌")
    assert "✅ Passed" in passed
    assert "library division" in failed
    for name in ("check.xml", "check.md", "check.json"):
        assert (repository / name).stat().st_size
    assert len((repository / "history.jsonl").read_text().splitlines()) == 2
