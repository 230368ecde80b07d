"""The driver of the two compiled engines: states become rows, Draws wait in a queue, threads run it."""
