"""One self-contained HTML page of a run: records and pictures in, text out. Opens offline, loads nothing."""
