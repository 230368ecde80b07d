"""An optional observer receives each stage's inputs and outputs: the column engine's, or the ideal's.

An observer is a callable. Each stage calls it with the stage's name and its columns, the arrays of the
computation itself. An observer that keeps them copies nothing and must not change them. The same functions
run observed and unobserved, so an observer sees what is drawn.
"""

from typing import Any


def unobserved(stage: str, /, **columns: Any) -> None:
    """The observer of a frame that has none: it ignores all that it is given."""
