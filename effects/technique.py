"""Ids of techniques, and their meanings. A technique's module declares its own under its imports, as
``TECHNIQUES``, a tuple of ``Technique`` and ``Variant``.

An id is a letter for the paper, or X for an effect of one's own, and a number. Figures and studies name the
ids of the techniques that they use; docs/papers/index.md is made of both.
"""

import re
from dataclasses import dataclass

# The page that says what every id is.
INDEX = "docs/papers/index.md"
# By an id's letter: the paper's number in the ids of figures and errata (F004-2, E004.1), and its key in
# docs/bibliography.bib.
PAPERS = {
    "H": ("000", "Heidrich2001"),
    "S": ("001", "Schilling1997"),
    "G": ("002", "HeidrichDaubertKautzSeidel2000"),
    "Z": ("003", "Zwicker2016"),
    "K": ("004", "KautzSeidel2000"),
}
# The letter of effects that are of none of these papers.
OWN = "X"


def _checked(identifier):
    if not isinstance(identifier, str) or re.fullmatch(rf"[{''.join(PAPERS)}{OWN}]\d\d", identifier) is None:
        raise ValueError(
            f"{identifier!r} is no technique's id. Give one of {', '.join(PAPERS)} and two digits: K07; or "
            f"{OWN} and two digits for an effect of your own."
        )


@dataclass(frozen=True)
class Technique:
    """A technique of a paper, declared by one module alone.

    id       its letter says which paper: "K10"
    what     the technique in one line
    section  its place in the paper: numbers of sections, "4.1, 6", or a slide's title

    Raises ValueError for an id that is not a paper's letter, or X, and two digits.
    """

    id: str
    what: str
    section: str

    def __post_init__(self):
        _checked(self.id)


@dataclass(frozen=True)
class Variant:
    """Techniques that other modules declare, drawn here by other means.

    ids  tuple of techniques' ids
    how  what differs, in a few words: "on a GeForce 3, by dot products"

    Raises ValueError for an id that is not a paper's letter, or X, and two digits, and for ids that are
    no tuple.
    """

    ids: tuple[str, ...]
    how: str

    def __post_init__(self):
        if not isinstance(self.ids, tuple):
            raise ValueError(f"The ids are {self.ids!r}; give a tuple of them: ('K07',).")
        for identifier in self.ids:
            _checked(identifier)
