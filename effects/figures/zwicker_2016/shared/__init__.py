"""Parts that figures of document 003 share."""
