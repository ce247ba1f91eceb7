"""Put the budget that `bfsim run` prints now into the README: `python docs/made/budget.py` after a change of any cycle."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

README = Path(__file__).parent.parent.parent / "README.md"
BLOCK = re.compile(r"(\$ bfsim run\n)(.*?)(\n\.\.\.\n```)", re.DOTALL)


def main() -> None:
    """Replace the lines beneath `$ bfsim run` by those that it prints, up to what ran: digests change with every file."""
    command = [sys.executable, "-m", "bfsim", "run"]
    environment = {**os.environ, "COLUMNS": "80"}
    printed = subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout
    budget = "\n".join(line.rstrip() for line in printed.split("\nRun ")[0].splitlines())
    README.write_text(BLOCK.sub(lambda found: found[1] + budget + found[3], README.read_text(), count=1))


if __name__ == "__main__":
    main()
