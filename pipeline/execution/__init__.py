"""Running commands on a machine."""
