"""What is told of golden pictures: a page that shows what differs, JSON, and JUnit's XML."""
