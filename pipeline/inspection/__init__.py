"""What happened to a pixel: a frame that is remembered, one pixel of it drawn again, every number on the way.

The numbers are the column engine's own: an observer (``fixedpipe.raster.observer``) is told what each
stage read and made while it draws.
"""
