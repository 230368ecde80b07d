"""Tokens and errors with places, which the notations ``!!RC1.0``, ``!!TS1.0`` and ``ps.1.x`` share."""

from math import isfinite
from typing import NamedTuple

# The number of a text's characters that a message quotes.
_QUOTED = 40


class ProgramTextError(ValueError):
    """A text that is no program of its notation; ``line`` and ``column`` (from 1) give the place."""

    def __init__(self, sentence, line, column):
        super().__init__(f"line {line}, column {column}: {sentence}")
        self.line, self.column = line, column


class Token(NamedTuple):
    """A word of a text; ``failure`` is the notation's own class of ProgramTextError."""

    kind: str
    text: str
    line: int
    column: int
    failure: type

    @property
    def found(self):
        """The token in words, for a message on what else belongs in its place."""
        if self.kind == "end":
            return "the text ends"
        rest = len(self.text) - _QUOTED
        return (
            f"found {self.text!r}"
            if rest <= 0
            else f"found {self.text[:_QUOTED]!r} and {rest} characters more"
        )

    def error(self, sentence):
        """The notation's error, at this token."""
        return self.failure(sentence, self.line, self.column)

    def number(self, sign=""):
        """The value of a number; ``sign`` is the text before it.

        Raises the notation's error for a number beyond the range of a float.
        """
        value = float(sign + self.text.lower().rstrip("f"))
        if not isfinite(value):
            raise self.error(f"{self.found}, a number beyond 10 to the power of 308; give a smaller one.")
        return value


def scan(text, pattern, failure, start=(1, 1)):
    """Yields the tokens of a text, without those of kind "space", with an "end" token last.

    They are read one at a time, so that a text of any length is read no further than its first error.

    - ``pattern``: one named group for each kind of token.
    - ``failure``: the error that is raised where no kind fits.
    - ``start``: line and column of the text's first character.
    """
    at, (line, column) = 0, start
    line_start = 1 - column
    while at < len(text):
        match = pattern.match(text, at)
        if match is None:
            here = Token("", text[at], line, at - line_start + 1, failure)
            if text.startswith("/*", at):
                raise here.error("this comment never ends; close it with */.")
            raise here.error(f"found the character {text[at]!r}, which the notation does not use; remove it.")
        word = match.group()
        if match.lastgroup != "space":
            yield Token(match.lastgroup, word, line, at - line_start + 1, failure)
        if newlines := word.count("\n"):
            line += newlines
            line_start = at + word.rindex("\n") + 1
        at = match.end()
    yield Token("end", "", line, at - line_start + 1, failure)


class Reader:
    """Goes through a text's tokens, from ``scan``.

    - ``next``: the next token; after the last, always the one of kind "end".
    - ``last``: the token before it.
    """

    def __init__(self, tokens):
        self.tokens = iter(tokens)
        self.next = self.last = next(self.tokens)

    def take(self):
        """The next token; the reader moves behind it."""
        self.last = self.next
        self.next = next(self.tokens, self.last)
        return self.last
