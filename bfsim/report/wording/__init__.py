"""The wording of numbers, of operations of the Blackfin, and of foreign names in reports."""
