"""The words of figures and studies, from their folders' data files: captions, bounds and their reasons.

A folder of figures has a ``figures.toml``, the studies have a ``studies.toml``. A figure's table has the
figure's id as its name. A check's table has the measured quantity as its name::

    [F004-4]
    title = "Two spheres brushed in different directions"
    [F004-4.checks."elongation of the highlight, longitudinal brushing"]
    at_least = 2.5
    reason = "the catalogue's acceptance"

A sentence may continue on further lines. If a bound or a reason differs for ideal and machine, its keys are
``at_least.ideal`` and ``at_least.machine``. The caller fills in ``{name}`` in a check's name or reason. A
bound that is computed stays in Python: docs/decisions/0031-words-in-data.md says why.
"""

import re
import string
import tomllib
from collections.abc import Callable, Iterable, Mapping
from functools import cache, cached_property
from pathlib import Path
from typing import Any, NoReturn

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.refusal import nearest

# The data files, by name: what each of their tables has, and what it may have.
WORDS = {
    "figures.toml": (
        ("title", "caption", "must_see", "source", "techniques"),
        ("panels", "parts", "compared", "shown_by"),
    ),
    "studies.toml": (("title", "question", "source", "techniques"), ("method",)),
}
# What is a tuple of texts; every other word is a text.
_SEVERAL = ("techniques", "panels", "parts")
# What is a tuple of whole numbers.
_NUMBERS = ("compared",)
# What is a tuple of tuples of texts.
_LISTS = ("shown_by",)
_OF_A_CHECK = ("at_most", "at_least", "reason")
_ANSWERS = {answer.value for answer in Answer}


class Data:
    """The contents of a data file for one figure or study.

    words  the fields of a Figure or a Study in the file, by name, with its id

    Raises ValueError, with a sentence that names the file, for missing entries and for entries that nothing
    reads.
    """

    def __init__(self, path: Path, identifier: str):
        self._id, self._file = identifier, f"{path.parent.name}/{path.name}"
        sections = sections_of(path)
        if identifier not in sections:
            raise ValueError(f"{self._file} has no [{identifier}].{nearest(identifier, sections)} Add it.")
        line, own, of_checks = sections[identifier]
        self._of_checks = line + own.count("\n"), of_checks
        needed, may = WORDS[path.name]
        found = self._table(line, own)
        self._refuse_unknown(f"[{identifier}]", found, (*needed, *may))
        for name in needed:
            if name not in found:
                self._refuse(f"[{identifier}] has no {name}; give it one.")
        self.words: Mapping[str, Any] = {"id": identifier} | {n: self._word(n, v) for n, v in found.items()}

    @cached_property
    def checks(self) -> Mapping[str, Mapping[str, Any]]:
        """The checks' tables by name. Raises ValueError as the class does."""
        tables = self._table(*self._of_checks)
        self._refuse_unknown(f"[{self._id}]", tables, ("checks",))
        found = tables.get("checks", {})
        for name, table in found.items():
            self._refuse_unknown(f"the check {name!r} of {self._id}", table, _OF_A_CHECK)
            for key, given in table.items():
                kinds, what = ((str,), "a text") if key == "reason" else ((int, float), "a number")
                answers = _answers(given)
                if answers.keys() != _ANSWERS or not all(type(one) in kinds for one in answers.values()):
                    self._refuse(
                        f"{key} of the check {name!r} of {self._id} is {given!r}; give {what}, or one with "
                        f"{key}.ideal and one with {key}.machine."
                    )
        return found

    def check(
        self,
        name: str,
        value: float,
        on: Answer,
        /,
        *,
        at_most: float | None = None,
        at_least: float | None = None,
        **fields: object,
    ) -> Check:
        """A measured number as a Check: its bound and its reason are the file's.

        at_most, at_least  a computed bound, if the file has none
        fields             the value of each ``{field}`` in the name and in the reason

        Raises ValueError for a name that is not in the file, for a bound given both here and there, for a
        check without a reason, for fields that are not in the name or the reason, and as Check.
        """
        if name not in self.checks:
            self._refuse(f"{self._id} has no check {name!r}.{nearest(name, self.checks)} Add it.")
        where, said = f"the check {name!r} of {self._id}", self.checks[name]
        given = {key: one for key, one in (("at_most", at_most), ("at_least", at_least)) if one is not None}
        for key in given.keys() & said.keys():
            self._refuse(f"{where} has {key}, and Python gives it too; leave one out.")
        if "reason" not in said:
            self._refuse(f"{where} has no reason; give it one.")
        if not isinstance(on, Answer):
            self._refuse(f"{where} is on {on!r}; give an Answer: {', '.join(map(str, Answer))}.")
        texts = name, *_answers(said["reason"]).values()
        named = {field for text in texts for _, field, _, _ in string.Formatter().parse(text) if field}
        if named != fields.keys():
            names = ", ".join(sorted(named)) or "no fields"
            self._refuse(f"{where} has {names}; Python gives {', '.join(sorted(fields)) or 'none'}.")
        taken = {key: _answers(found)[on.value] for key, found in said.items()} | given
        reason = _sentence(taken.pop("reason")).format(**fields)
        return Check(name.format(**fields), value, on=on, reason=reason, **taken)

    def _table(self, line: int, text: str) -> Any:
        """A piece of the file, which has so many lines before it, as the table of the id."""
        try:
            return tomllib.loads("\n" * line + text).get(self._id, {})
        except tomllib.TOMLDecodeError as error:
            self._refuse(f"{error}.", error)

    def _word(self, name: str, value: object) -> str | tuple[Any, ...]:
        if name in _NUMBERS:
            if not _is_list(value, lambda number: type(number) is int):
                self._refuse(f"{name} of [{self._id}] is {value!r}; give a list of whole numbers.")
            numbers: Any = value
            return tuple(numbers)
        if name in _LISTS:
            rows: Any = value
            if not _is_list(rows, _are_texts):
                self._refuse(f"{name} of [{self._id}] is {value!r}; give a list of lists of texts.")
            return tuple(tuple(map(_sentence, row)) for row in rows)
        texts: Any = value if name in _SEVERAL else [value]
        if not _are_texts(texts):
            what = "a list of texts" if name in _SEVERAL else "a text"
            self._refuse(f"{name} of [{self._id}] is {value!r}; give {what}.")
        sentences = tuple(map(_sentence, texts))
        return sentences if name in _SEVERAL else sentences[0]

    def _refuse_unknown(self, where: str, table: Mapping[str, Any], names: Iterable[str]) -> None:
        for name in table.keys() - {*names}:
            self._refuse(
                f"{where} has {name!r}, which nothing reads.{nearest(name, names)} There are: "
                f"{', '.join(names)}."
            )

    def _refuse(self, sentence: str, cause: Exception | None = None) -> NoReturn:
        raise ValueError(f"{self._file}: {sentence}") from cause


def figure_data(module: str, identifier: str) -> Data:
    """A figure's Data, from ``figures.toml`` beside its module, whose ``__file__`` is given. Raises as
    Data.
    """
    return Data(Path(module).with_name("figures.toml"), identifier)


def study_data(module: str, identifier: str) -> Data:
    """A study's Data, from ``studies.toml`` beside its module. Raises as Data."""
    return Data(Path(module).with_name("studies.toml"), identifier)


@cache
def sections_of(path: Path) -> Mapping[str, tuple[int, str, str]]:
    """A data file by ids: how many lines stand before an id's table, its text, the text of its checks.

    So only what is needed is parsed: listing the figures parses no check. Raises ValueError for a file that
    cannot be read, and if the tables of one id are not adjacent.
    """
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror}.") from None
    found: dict[str, tuple[int, str, str]] = {}
    last, line = "", 0
    for section in re.split(r"^(?=\[)", text, flags=re.MULTILINE):
        if table := re.match(r"\[([\w-]+)(\.?)", section):
            identifier, below = table.groups()
            if (identifier != last) if below else (identifier in found):
                where = f"{path.parent.name}/{path.name}: line {line + 1}"
                raise ValueError(f"{where} is of {identifier}, whose tables end before; move it there.")
            start, own, checks = found.get(identifier, (line, section, ""))
            found[identifier], last = (start, own, checks + section * bool(below)), identifier
        line += section.count("\n")
    return found


def _answers(found: Any) -> Mapping[str, Any]:
    """What a check's table has under a name, for each answer."""
    return found if isinstance(found, dict) else dict.fromkeys(_ANSWERS, found)


def _is_list(found: object, fits: Callable[[Any], bool]) -> bool:
    return isinstance(found, list) and all(map(fits, found))


def _are_texts(found: object) -> bool:
    return _is_list(found, lambda text: isinstance(text, str))


def _sentence(text: str) -> str:
    """A text of several lines in one."""
    return " ".join(text.splitlines())
