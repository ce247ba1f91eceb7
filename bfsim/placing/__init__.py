"""`bfsim place`: measure a run, solve an integer programme for where everything lies, write it as an LDF, and run that."""
