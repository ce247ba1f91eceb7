"""Value ranges: between which numbers a value is."""
