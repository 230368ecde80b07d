"""The machine, which runs a frame's commands on the engines."""
