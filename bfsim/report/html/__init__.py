"""One self-contained HTML page of a run: records and pictures in, text out. It opens offline and loads nothing."""
