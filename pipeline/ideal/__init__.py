"""The second answer: the same passes in real numbers, cut as an engine is cut."""
