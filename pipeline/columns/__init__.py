"""The column engine's driver: it reads states and gives columns to ``fixedpipe.raster.columns``."""
