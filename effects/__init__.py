"""The papers' techniques, the figures that show them, and studies of the hardware's effects.

A technique is a module that returns the paper's own sequence of commands and draws nothing itself. Folders
are named after subjects: shadows, volumes, reflectance. Techniques are made of ``geometry``, ``passes`` and
``scenes``; ``acceptance`` measures; ``reports`` and ``cli`` show.
"""
