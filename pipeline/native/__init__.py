"""The driver of the two compiled engines: state to rows, queue, threads."""
