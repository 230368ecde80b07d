"""How fast the machine draws, measured beside another renderer: ``python -m bench``."""
