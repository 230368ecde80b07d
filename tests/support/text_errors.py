"""Errors of notations: a line, a column and a sentence."""

import pytest


def assert_says_where_and_what(error, read, text, line, column, words):
    """``read(text)`` raises ``error`` at a line and column, in a sentence that has all ``words``."""
    with pytest.raises(error) as caught:
        read(text)
    message = str(caught.value)
    assert (caught.value.line, caught.value.column) == (line, column), message
    assert message.startswith(f"line {line}, column {column}: ")
    assert all(word in message for word in words), message
    assert message.endswith(".")
