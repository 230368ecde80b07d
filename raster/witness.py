"""Who watches a computation, the column engine's or the ideal's.

A witness is a callable that each stage tells what it read and what it made. A stage says its
name and its columns, as they are in the computation: a witness that keeps them copies none, and changes
none. The same functions run watched and unwatched, so what is seen is what is drawn.
"""

from typing import Any


def nobody(stage: str, /, **columns: Any) -> None:
    """The witness of a frame that nobody watches."""
