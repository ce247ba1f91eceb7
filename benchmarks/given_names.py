"""Names of kernels on the command line of a benchmark."""

from __future__ import annotations

import argparse
from collections.abc import Sequence


def given_names(about: str, known: Sequence[str]) -> list[str]:
    """Return those that are given of the `known` ones, none for all; `about` is what `--help` says first."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", choices=known, help="of a kernel (default: all)")
    names: list[str] = parser.parse_args().names
    return names
