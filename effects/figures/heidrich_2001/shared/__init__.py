"""Parts that figures of document 000 share."""
