"""What happens to geometry before any engine shades: shared by all three, knows no fragment."""
