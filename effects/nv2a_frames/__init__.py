"""Frames as the NV2A receives them: words of its registers, vertices and memory, in one small file.

``methods`` names the registers, ``writing`` makes a file of commands, ``reading`` makes commands of a file.
docs/nv2a-frames.md describes the format, and docs/examples/nv2a_frame.h writes it from C.
"""
