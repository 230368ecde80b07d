"""The gallery of ``fixedpipe figures``: pages over records and pictures that lie beside them."""

from fixedpipe.effects.reports.gallery.catalogue import FOLDER as CATALOGUE
from fixedpipe.effects.reports.gallery.page import INDEX, PLAIN, pages

__all__ = ["CATALOGUE", "INDEX", "PLAIN", "pages"]
