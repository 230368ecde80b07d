"""Some figures, or changed ones, in place of all: drawn in one process, for others have all."""

from fixedpipe.effects.figures import FIGURES


class Few(dict):
    """Figures by id that stand for ``fixedpipe.effects.figures.FIGURES``."""

    module_of = staticmethod(FIGURES.module_of)
