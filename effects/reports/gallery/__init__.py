"""The gallery: the page that shows every figure of a folder, and opens from a file without a server."""

from fixedpipe.effects.reports.gallery.page import gallery

__all__ = ["gallery"]
