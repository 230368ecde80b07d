"""Recorded programs on emulated machines: a trace's calls, window by window and frame by frame."""
