"""What the notations ``!!RC1.0``, ``!!TS1.0`` and ``ps.1.x`` share: tokens, errors that say where."""

from typing import NamedTuple


class ProgramTextError(ValueError):
    """A text that is no program of its notation; ``line`` and ``column`` (from 1) say where."""

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
        """The token in words, for a sentence that says what else belongs in its place."""
        return "the text ends" if self.kind == "end" else f"found {self.text!r}"

    def error(self, sentence):
        """The notation's error, at this token."""
        return self.failure(sentence, self.line, self.column)


def scan(text, pattern, failure, start=(1, 1)):
    """The tokens of a text, those of kind "space" left out, an "end" token last.

    ``pattern``: one named group for each kind of token. ``start``: line and column of the text's first
    character. Raises ``failure`` where no kind fits.
    """
    tokens, at, (line, column) = [], 0, start
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
            tokens.append(Token(match.lastgroup, word, line, at - line_start + 1, failure))
        if newlines := word.count("\n"):
            line += newlines
            line_start = at + word.rindex("\n") + 1
        at = match.end()
    tokens.append(Token("end", "", line, at - line_start + 1, failure))
    return tokens


class Reader:
    """Goes through a text's tokens, as ``scan`` gives them."""

    def __init__(self, tokens):
        self.tokens, self.at = tokens, 0

    @property
    def next(self):
        """The token that comes, at last the one of kind "end" again and again."""
        return self.tokens[self.at]

    def take(self):
        """The token that comes, behind which the reader then is."""
        token = self.next
        self.at = min(self.at + 1, len(self.tokens) - 1)
        return token
