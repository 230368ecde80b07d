"""Accepting pictures: only where this installation draws what every installation does."""

from collections.abc import Iterable
from pathlib import Path

from fixedpipe.pipeline.golden.candidates import Candidate, accept


def accept_where_sound(root: Path, candidates: Iterable[Candidate]) -> list[str]:
    """Accept them, one after the other; the sentences on what changed.

    Raises StoreError; what was accepted before the one that cannot be stays accepted.
    """
    return [accept(root, candidate) for candidate in candidates]
