"""Reports on drawn figures and studies: records, galleries and pages, pictures. No command line."""
