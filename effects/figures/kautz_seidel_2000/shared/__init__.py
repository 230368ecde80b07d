"""Parts that figures of document 004 share."""
