"""The page of what `--json` writes names every key that it has, in the section of the command."""

from __future__ import annotations

import json
import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from bfsim.report.kernels.verification import verification_json
from bfsim.shipped import RECORDING
from bfsim.trace.verification import Verification, VerifiedKernel
from tests.commands import bfsim
from tests.tiers import exhaustive

PAGE = Path(__file__).parents[1] / "docs" / "json.md"
COMMON = {"schema"}


@cache
def sections() -> dict[str, str]:
    """The text of each section, by the command in its heading."""
    _, *parts = re.split(r"^## ", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return {
        command: text
        for heading, text in (part.split("\n", 1) for part in parts)
        for command in re.findall(r"`bfsim ([\w ]+)`", heading)
    }


def written(*arguments: str, cwd: Path | None = None) -> dict[str, Any]:
    """What a command prints as JSON."""
    found: dict[str, Any] = json.loads(bfsim(*arguments, "--json", cwd=cwd).stdout)
    return found


@pytest.mark.parametrize(
    "arguments",
    [
        ("run", "--frames", "1"),
        ("profile", "--frames", "1"),
        ("diff", "--frames 1", "--frames 1"),
        ("explain", "isqrt32"),
        ("explain", "isqrt32", "--asm"),
        ("ldf",),
        ("colours",),
        *exhaustive((("place", "--frames", "1", "--ldf", "l2"),)),
    ],
    ids=str,
)
def test_every_key_is_on_the_page(arguments: tuple[str, ...]) -> None:
    """Those of the outermost object; `api.md` has the fields of the records in it."""
    keys = written(*arguments).keys() - COMMON
    named = set(re.findall(r"`(\w+)`", sections()[arguments[0]]))
    assert keys <= named


def test_every_key_of_a_check_is_on_the_page(tmp_path: Path) -> None:
    """Those of each run, too."""
    (tmp_path / "budget.toml").write_text('[[run]]\nname = "a"\nframes = 1\nrequire = ["missed == 0"]\n')
    found = written("check", "--baseline", "budget.toml", cwd=tmp_path)
    named = set(re.findall(r"`(\w+)`", sections()["check"]))
    assert found.keys() - COMMON | found["runs"][0].keys() <= named


def test_every_key_of_a_recording_is_on_the_page() -> None:
    """Those of each camera, too."""
    found = written("record", "info", str(RECORDING))
    named = set(re.findall(r"`(\w+)`", sections()["record info"]))
    assert found.keys() - COMMON | found["left"].keys() <= named


def test_every_key_of_a_verification_is_on_the_page() -> None:
    """Those of each kernel, too. The records are made here: `bfsim verify` takes half a minute."""
    kernel = VerifiedKernel("a", "a.py", 1, 1, 1, 110, 100, 0, 0)
    found = json.loads(verification_json(Verification("gcc-O2", "12.2.0", 1, True, (kernel,))))  # noqa: FBT003
    named = set(re.findall(r"`(\w+)`", sections()["verify"]))
    assert found.keys() - COMMON | found["kernels"][0].keys() <= named
