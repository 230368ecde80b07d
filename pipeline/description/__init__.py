"""States and commands in words and equations, for ``fixedpipe passes``."""
