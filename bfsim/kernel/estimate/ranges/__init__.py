"""Value ranges: the numbers between which a value lies."""
