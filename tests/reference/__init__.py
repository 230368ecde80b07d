"""The executable specification: plain Python numbers, one fragment at a time, one function per rule.

It states docs/numbers.md a second time, independently of ``raster``: kernels must equal it to the bit.
Every function names where its rule comes from (Source, Measured, Inferred, Assumed). Only the standard
library and the pipeline's enumerations, states and profiles are imported.
"""
