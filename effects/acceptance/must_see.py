"""What must be seen of a figure, sentence by sentence, and the checks that each sentence names."""

import re


def sentences(text: str) -> list[str]:
    """A paragraph cut into its sentences.

    A new one begins with a capital after a full stop, and not after a single letter or an abbreviation.
    """
    shortened = "".join(rf"(?<!\b{word}\.)" for word in ("Eq", "Fig", "cf", "vs", "[A-Za-z]"))
    return re.split(rf"(?<=[.!?]){shortened}\s+(?=[A-Z(])", text.strip())


def is_named(check: str, name: str) -> bool:
    """Whether a check has the name that a data file gives, with any text in place of the name's fields."""
    words = re.split(r"\{[^{}]*\}", name)
    return re.fullmatch(".+?".join(map(re.escape, words)), check) is not None
