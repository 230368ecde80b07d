"""One module per technique; each returns the paper's own sequence of commands and draws nothing itself."""
