"""Parts that figures of document 001 share."""
