"""Reports of what was drawn: records, galleries and pages, pictures. No command line."""
