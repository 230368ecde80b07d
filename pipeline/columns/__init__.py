"""The driver of the column engine: states are read, and columns given to ``fixedpipe.raster.columns``."""
