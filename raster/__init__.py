"""The engines' fixed-point arithmetic: integers and arrays in, arrays out.

``portable`` and ``vector`` are compiled engines; ``columns`` is the third engine's arithmetic, in NumPy.
``primitives`` serves all three; ``pixels`` works on whole images. Nothing here knows of passes, profiles or
papers.
"""
