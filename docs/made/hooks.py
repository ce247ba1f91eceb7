"""What MkDocs fills into the pages while it builds them: tables that are read from the sources, so that they stay true."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

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


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Put the README and each table in the place of their comments, such as <!-- table: assumed numbers -->."""
    markdown = markdown.replace("<!-- README -->", _readme())
    return re.sub(r"<!-- table: (.+?) -->", lambda found: TABLES[found[1]](), markdown)
