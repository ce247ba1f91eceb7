"""What MkDocs fills into the pages while it builds them: what is read from the sources, so that it stays true."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from bfsim.cli.main import main

ROOT = Path(__file__).parent.parent.parent
CHIP = ROOT / "bfsim" / "chip"
ASSUMED = re.compile(r"^\s*(?P<code>[^#]*?),?\s*#\s*(?P<before>.*?)\[assumed\]\s*(?P<why>.*)$")


def assumed_numbers() -> Iterator[tuple[str, str, str]]:
    """Yield (file, number, why it is assumed) for every line of `bfsim/chip` that tags its number so."""
    for path in sorted(CHIP.glob("*.py")):
        for line in path.read_text().splitlines():
            if (found := ASSUMED.match(line)) and found["code"]:
                why = f"{found['before'].strip(' ;')}; {found['why']}" if found["before"] else found["why"]
                yield path.name, found["code"], why.strip("; ")


def _table_of_assumed() -> str:
    rows = [f"| `{number}` | {why} | `chip/{file}` |" for file, number, why in assumed_numbers()]
    return "\n".join(["| number | assumed because | where |", "|---|---|---|", *rows])


TABLES = {"assumed numbers": _table_of_assumed}


def _readme() -> str:
    """Return the README with its links as the pages of `docs/` see them."""
    return (ROOT / "README.md").read_text().replace("](docs/", "](").replace('src="docs/', 'src="')


def _helps(command: click.Command, parent: click.Context | None = None) -> Iterator[str]:
    """Yield what `--help` prints of a command, and then of those below it, each under a heading."""
    context = click.Context(
        command,
        parent,
        info_name=command.name if parent else "bfsim",
        terminal_width=80,
        **command.context_settings,
    )
    yield f"## {context.command_path}\n\n```text\n{command.get_help(context)}\n```\n"
    for _, each in sorted(getattr(command, "commands", {}).items()):
        yield from _helps(each, context)


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Put the README, the help and each table in the place of their comments, such as <!-- table: assumed numbers -->."""
    markdown = markdown.replace("<!-- README -->", _readme()).replace(
        "<!-- help -->", "\n".join(_helps(main))
    )
    return re.sub(r"<!-- table: (.+?) -->", lambda found: TABLES[found[1]](), markdown)
