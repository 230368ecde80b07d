"""Replays recorded programs on emulated machines: the calls of a trace, by window and by frame."""
