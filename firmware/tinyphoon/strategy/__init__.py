"""What the strategy unit sends, modes and models, and the results that it receives."""
