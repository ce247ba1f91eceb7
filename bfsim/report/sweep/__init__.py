"""The results of a sweep: a table of all points, those on the Pareto front, and a plot."""
