"""Accepting pictures: only on an installation that draws the accepted bits."""

from collections.abc import Iterable
from pathlib import Path

from fixedpipe.pipeline.golden.candidates import Candidate, accept
from fixedpipe.pipeline.golden.store import StoreError
from fixedpipe.pipeline.native.background_compiling import without_waiting


def accept_where_sound(root: Path, candidates: Iterable[Candidate]) -> list[str]:
    """Accept the candidates in order; returns sentences on the changes.

    Nothing is accepted where the quick self-test fails. The test runs once for an installation; without
    compiled kernels it draws without them. Raises StoreError; candidates before the one that fails stay
    accepted.
    """
    from fixedpipe.pipeline.selftest.quick import failures

    candidates = tuple(candidates)
    if not candidates:
        return []
    with without_waiting():
        found = failures()
    if found:
        more = f" (and {len(found) - 1} more)" if len(found) > 1 else ""
        raise StoreError(
            f"Nothing was accepted: this installation does not draw the accepted bits. {found[0]}{more} Run "
            "`fixedpipe selftest`, and accept pictures where it passes."
        )
    return [accept(root, candidate) for candidate in candidates]
