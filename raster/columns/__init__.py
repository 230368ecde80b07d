"""The arithmetic of the column engine: NumPy on int64 columns, every width a parameter. No kernels."""
