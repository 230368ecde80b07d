"""What figures of document 000 share."""
