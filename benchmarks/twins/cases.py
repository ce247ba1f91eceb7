"""Every twin there is."""

from __future__ import annotations

from benchmarks.twins import (
    angles,
    bits,
    cameras,
    codes,
    controllers,
    digits,
    drawing,
    exchanges,
    fills,
    filters,
    grids,
    heaps,
    integers,
    labels,
    lines,
    lookups,
    mixture,
    neighbours,
    ordering,
    patches,
    pictures,
    pixels,
    protocols,
    regions,
    rows,
    samples,
    shapes,
    signals,
    sorted_rows,
    sorting,
    tables,
    tallies,
    text,
    transforms,
    words,
)

SUBJECTS = (
    angles, bits, cameras, codes, controllers, digits, drawing, exchanges, fills, filters, grids, heaps,
    integers, labels, lines, lookups, mixture, neighbours, ordering, patches, pictures, pixels,
    protocols, regions, rows, samples, shapes, signals, sorted_rows, sorting, tables, tallies, text,
    transforms, words,
)  # fmt: skip
CASES = tuple(case for subject in SUBJECTS for case in subject.CASES)
