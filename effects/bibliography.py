"""Papers from the bibliography: an entry's own text, and plain words.

bibliography.bib beside this module is a link to the one in docs/. A wheel holds it as a file.
"""

import re
import unicodedata
from dataclasses import dataclass
from functools import cache
from pathlib import Path

BIBLIOGRAPHY = Path(__file__).with_name("bibliography.bib")

# TeX's accents as Unicode's combining marks.
_ACCENTS = {'"': "\N{COMBINING DIAERESIS}", "'": "\N{COMBINING ACUTE ACCENT}"}
_WORDS = {r"\ss": "ß", r"\&": "&", r"\_": "_", "--": "\N{EN DASH}"}


@dataclass(frozen=True)
class Citation:
    """A paper: its ``key`` in the bibliography, its entry there, ``bibtex``, and ``authors``, ``title`` and
    ``year`` in plain words.
    """

    key: str
    bibtex: str
    authors: str
    title: str
    year: str

    @property
    def words(self):
        """The paper in a line: authors, title, year."""
        return ", ".join(part for part in (self.authors, self.title, self.year) if part)


def plain(text):
    """A field's text without the marks of TeX."""
    for mark, letter in _WORDS.items():
        text = text.replace(mark, letter)
    for mark, combining in _ACCENTS.items():
        text = re.sub(rf"\\{mark}\{{?(\w)\}}?", rf"\1{combining}", text)
    return unicodedata.normalize("NFC", re.sub(r"[{}]", "", text))


@cache
def citation(key):
    """The Citation of a paper by its key. Raises KeyError where the bibliography has none."""
    text = BIBLIOGRAPHY.read_text(encoding="utf-8")
    entry = re.search(rf"^@\w+\{{{re.escape(key)},\n(.*?)^\}}", text, re.MULTILINE | re.DOTALL)
    if entry is None:
        raise KeyError(key)
    fields = dict(re.findall(r"^  (\w+) = \{?(.*?)\}?,?$", entry[1], re.MULTILINE))
    names = plain(fields.get("author", fields.get("organization", ""))).split(" and ")
    authors = " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))
    return Citation(key, f"{entry[0]}\n", authors, plain(fields["title"]), fields["year"])
