"""Fixed-point kernels. Integers and arrays in, arrays out; knows nothing of passes, profiles or papers."""
