"""A fixed set of small frames, drawn on this machine by every engine and compared with accepted digests."""
