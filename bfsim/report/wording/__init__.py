"""How reports say numbers, operations of the Blackfin, and names that others gave."""
