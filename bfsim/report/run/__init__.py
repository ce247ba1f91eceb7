"""The report of a run: on one screen, in every table, and its warnings."""
