"""`bfsim place`: measure a run, find the best placement by an integer programme, write it as an LDF, and run it."""
