"""Parts that figures of document 002 share."""
