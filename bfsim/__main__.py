"""`python -m bfsim`: the command line without the installed script."""

from __future__ import annotations

from bfsim.cli import main

if __name__ == "__main__":
    main(prog_name="bfsim")
