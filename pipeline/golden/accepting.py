"""Accepting pictures: only where this installation draws what every installation does."""

from collections.abc import Iterable
from pathlib import Path

from fixedpipe.pipeline.golden.candidates import Candidate, accept
from fixedpipe.pipeline.golden.store import StoreError
from fixedpipe.pipeline.native.readiness import without_waiting


def accept_where_sound(root: Path, candidates: Iterable[Candidate]) -> list[str]:
    """Accept them, one after the other; the sentences on what changed.

    Raises StoreError; what was accepted before the one that cannot be stays accepted. Nothing is accepted
    where the quick self-test fails, which runs once for an installation; where no kernels are compiled it
    draws without them.
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
