"""The README and the pages are true: their commands, options and files exist, links lead somewhere, and the README is short."""

from __future__ import annotations

import re
from pathlib import Path

import click
import pytest

from bfsim.cli.main import main
from tests.pages import PAGES, ROOT

README = (ROOT / "README.md").read_text()
CONTRIBUTING = ROOT / "CONTRIBUTING.md"
IN_CODE = re.compile(r"`(?P<inline>[^`\n]+)`|^    (?P<block>.*)$", re.MULTILINE)
OF_OTHERS = {"--recording", "--ablate", "--no", "--inline"}
"""Options of pytest, of scripts and of git."""


def options_of(command: click.Command) -> set[str]:
    """Every long option of a command and of those below it."""
    found = {
        name
        for each in command.params
        for name in (*each.opts, *each.secondary_opts)
        if name.startswith("--")
    }
    for each in getattr(command, "commands", {}).values():
        found |= options_of(each)
    return found | {"--help", "--version"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_the_options_of_a_page_exist(page: Path) -> None:
    """An option that a page names behind `bfsim`, or in code by itself, is one of a command."""
    text = page.read_text()
    named = set(re.findall(r"`(--[a-z-]+)", text))
    named |= {
        option for line in re.findall(r"bfsim [^`\n]*", text) for option in re.findall(r" (--[a-z-]+)", line)
    }
    assert not named - options_of(main) - OF_OTHERS


@pytest.mark.parametrize("page", (*PAGES, CONTRIBUTING), ids=lambda page: str(page.relative_to(ROOT)))
def test_the_files_of_a_page_exist(page: Path) -> None:
    """Every file and folder of the repository that a page names in code, in a line or a block, is there, and so is what it links to."""
    text = page.read_text()
    in_code = [
        word for found in IN_CODE.finditer(text) for word in (found["inline"] or found["block"]).split()
    ]
    named = {
        word for word in in_code if re.match(r"(bfsim|firmware|benchmarks|tests|ldf|docs|\.ci)/\w", word)
    }
    missing = [each for each in named if "*" not in each and not (ROOT / each).exists()]
    links = [
        each for each in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text) if not (page.parent / each).exists()
    ]
    assert not missing + links


def test_the_readme_is_short() -> None:
    """Lines fit 120 columns, tables aside, and there are not many of them."""
    lines = README.splitlines()
    assert max(len(each) for each in lines if not each.startswith("|")) <= 120
    assert len(lines) <= 120
