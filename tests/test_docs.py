"""The documentation is true: every command and code block of README and docs/ does what its page says."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.pages import PAGES, ROOT, blocks_of, compare, reader


@pytest.mark.exhaustive
@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_the_blocks_of_a_page_run_one_after_the_other(page: Path) -> None:
    """Files are written and commands run in an empty folder, as the reader of the page would do it."""
    with reader() as somebody:
        for block in blocks_of(page):
            if not block.runner:
                for command, printed, output in somebody.play(block):
                    compare(printed, output, f"{command} (line {block.line})")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_what_somebody_else_runs_stands_there(page: Path) -> None:
    """A block that names its runner has its commands in that file, word for word."""
    for block in blocks_of(page):
        if block.runner:
            runner = (ROOT / block.runner).read_text()
            for line in block.text.strip().splitlines():
                assert line.strip().removeprefix("$ ") in runner, f"{page.name}:{block.line}: {line}"


def test_every_block_says_what_it_is() -> None:
    """A block without a language would be shown and never tried."""
    bare = [f"{page.name}:{each.line}" for page in PAGES for each in blocks_of(page) if not each.language]
    assert not bare
