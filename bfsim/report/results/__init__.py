"""The records of a run and what was seen in it as JSON; and reading them back."""
