"""What figures of document 003 share."""
