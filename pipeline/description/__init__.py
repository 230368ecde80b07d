"""States and commands in words and equations, as ``fixedpipe passes`` prints them."""
