"""From the records of a run to statistics, tables, JSON, digests and baselines. Pure functions that know no machine."""
