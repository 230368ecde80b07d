"""The papers' techniques, the figures that show them, and the studies of what the hardware did.

A technique is a module that returns the paper's own sequence of commands and draws nothing itself. Folders
are named after subjects: shadows, volumes, reflectance. ``geometry``, ``passes`` and ``scenes`` are what
techniques are made of, ``acceptance`` measures, ``reports`` and ``cli`` show.
"""
