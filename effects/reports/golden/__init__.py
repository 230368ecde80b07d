"""Reports on golden pictures: a page with the differences, JSON, and JUnit's XML."""
