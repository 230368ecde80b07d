"""What is written of what was drawn: records, galleries, pictures. No command line."""
