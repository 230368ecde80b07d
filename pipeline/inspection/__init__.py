"""What happened to a pixel: a recorded frame, one of its pixels drawn again, and every number on the way.

The numbers are the column engine's own. While it draws, an observer (``fixedpipe.raster.observer``) receives
each stage's inputs and outputs.
"""
