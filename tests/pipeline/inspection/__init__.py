"""Looking into frames."""
