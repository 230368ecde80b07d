"""A recogniser of grammars that are data: rules as text in, a tree of tuples out.

    program = "!!TS1.0" { instruction ";" } .
    instruction = /texture_[123]d/ "(" ")" | "cull_fragment" "(" condition { "," condition } ")" .

A rule's right side has words in quotes, patterns of a whole word between slashes, names of rules, ( ) for
grouping, [ ] for what may be missing, { } for what may be repeated, and | between choices. The first choice
that fits is taken, and as many repetitions as fit (parsing expression grammars: B. Ford, POPL 2004).
"""

import re
from string import ascii_lowercase, ascii_uppercase

_ELEMENT = re.compile(r'\s+|"(?P<word>[^"]+)"|/(?P<pattern>[^/]+)/|(?P<rule>[a-z_]+)|(?P<mark>[=|.()\[\]{}])')

_LOWER = str.maketrans(ascii_uppercase, ascii_lowercase)


class RejectedError(ValueError):
    """A text that is not of the language; the sentence is for whoever reads a failing test."""


class Grammar:
    """Rules, of which the first is the whole text's. ``lexicon``: a pattern of one word, in a group named
    "word", or of what is between words; whatever it does not match is no word. ``fold``: capital letters of
    ASCII are small ones.
    """

    def __init__(self, rules, lexicon, fold=False):
        self.lexicon, self.fold = re.compile(lexicon, re.VERBOSE | re.DOTALL), fold
        elements = [m for m in _ELEMENT.finditer(rules) if m.lastgroup]
        self.rules, at = {}, 0
        while at < len(elements):
            name = elements[at]["rule"]
            self.rules[name], at = self._choices(elements, at + 2)
            at += 1  # the full stop
        self.first = next(iter(self.rules))

    def _choices(self, elements, at):
        choices, sequence = [], []
        while elements[at]["mark"] not in (".", ")", "]", "}"):
            element, mark = elements[at], elements[at]["mark"]
            at += 1
            if mark == "|":
                choices.append(("all", sequence))
                sequence = []
            elif mark:
                inner, at = self._choices(elements, at)
                sequence.append(({"(": "group", "[": "maybe", "{": "many"}[mark], inner))
                at += 1
            else:
                sequence.append((element.lastgroup, element[element.lastgroup]))
        return ("choice", [*choices, ("all", sequence)]), at

    def words(self, text):
        """The words of a text. Raises RejectedError."""
        text, words, at = text.translate(_LOWER) if self.fold else text, [], 0
        while at < len(text):
            match = self.lexicon.match(text, at)
            if match is None or match.end() == at:
                raise RejectedError(f"no word at {text[at : at + 20]!r}")
            words += [match["word"]] if match["word"] is not None else []
            at = match.end()
        return words

    def tree(self, text):
        """The text as (rule, parts ...): a part is a word or such a tuple. Raises RejectedError."""
        words = self.words(text)
        found = self._match(("rule", self.first), words, 0)
        if found is None or found[1] < len(words):
            raise RejectedError(f"no {self.first}: {' '.join(words[: found[1] if found else 0][-8:])!r}")
        return found[0][0]

    def _match(self, node, words, at):
        """(parts, where what follows begins), or None."""
        kind, content = node
        if kind in ("word", "pattern"):
            fits = at < len(words) and (
                words[at] == content if kind == "word" else re.fullmatch(content, words[at])
            )
            return ([words[at]], at + 1) if fits else None
        if kind == "rule":
            found = self._match(self.rules[content], words, at)
            return found and ([(content, *found[0])], found[1])
        if kind == "choice":
            return next(filter(None, (self._match(choice, words, at) for choice in content)), None)
        if kind == "group":
            return self._match(content, words, at)
        if kind == "maybe":
            return self._match(content, words, at) or ([], at)
        parts = []
        if kind == "many":
            while (found := self._match(content, words, at)) is not None:
                parts, at = parts + found[0], found[1]
            return parts, at
        for part in content:  # all of a sequence
            found = self._match(part, words, at)
            if found is None:
                return None
            parts, at = parts + found[0], found[1]
        return parts, at


def parts(tree, rule):
    """The parts of a tree's node that ``rule`` made."""
    return [part for part in tree[1:] if part[0] == rule and isinstance(part, tuple)]


def part(tree, rule):
    """The only such part, or None."""
    (found,) = parts(tree, rule) or (None,)
    return found
