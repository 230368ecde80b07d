"""A fixed set of small frames that every engine draws on this machine, compared with accepted digests."""
