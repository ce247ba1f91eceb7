"""What a sweep found: a table of all points, those on the Pareto front, and a plot."""
