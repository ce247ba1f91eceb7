"""Every twin there is."""

from __future__ import annotations

from benchmarks.twins import (
    angles,
    bits,
    drawing,
    filters,
    grids,
    heaps,
    integers,
    labels,
    lines,
    lookups,
    ordering,
    patches,
    pixels,
    regions,
    rows,
    signals,
    tables,
    text,
    words,
)

SUBJECTS = (
    *(angles, bits, drawing, filters, grids, heaps, integers, labels, lines, lookups),
    *(ordering, patches, pixels, regions, rows, signals, tables, text, words),
)
CASES = tuple(case for subject in SUBJECTS for case in subject.CASES)
