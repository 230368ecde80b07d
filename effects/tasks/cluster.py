"""A cluster of Dask as its client sees it: how many workers it has, and whether it still answers.

A host that fails sends no message. Its connections may stay open, as those of a stopped process do. Then the
client knows only by a time limit that the host is lost.
"""

import time
from contextlib import suppress

from fixedpipe.effects.refusal import Refusal

_SECONDS_BETWEEN_COUNTS = 2.0  # of a cluster's workers, whose number changes
# A scheduler that does not answer for so long is lost. So is a cluster that has no workers for so long.
# Source: Dask's own time for a worker, distributed.scheduler.worker-ttl, of its distributed.yaml.
SECONDS_UNTIL_LOST = 300.0
_SECONDS_TO_CLOSE = 5.0
_GO_ON = "What was finished is kept; give the same command to go on from there."


class Cluster:
    """A callable that returns how many threads the workers have. The number may be a few seconds old.

    client             the client of Dask
    among              the addresses of the workers to count; None: all
    waits_for_workers  whether to wait for ever if there is no worker

    Raises Refusal if the scheduler does not answer for SECONDS_UNTIL_LOST, or has had no worker for as long.
    """

    def __init__(self, client, among=None, *, waits_for_workers=True):
        self._client, self._among, self._waits = client, among, waits_for_workers
        self._counted, self._counted_at, self._known = 0, None, {}
        self._answered = time.monotonic()
        self._alone_since = None  # when it was first seen without workers

    def __call__(self):
        """How many threads the workers have."""
        if self._counted_at is None or time.monotonic() - self._counted_at >= _SECONDS_BETWEEN_COUNTS:
            known, among = self.known(), self._among
            self._counted = sum(w["nthreads"] for n, w in known.items() if among is None or n in among)
            self._counted_at = time.monotonic()
            self._alone_since = None if self._counted else self._alone_since or self._counted_at
        alone = self._alone_since is not None and self._counted_at - self._alone_since
        if not self._waits and alone > SECONDS_UNTIL_LOST:
            raise Refusal(
                f"The scheduler {self._address()} has had no worker for {SECONDS_UNTIL_LOST:g} s; begin some "
                f"by dask worker {self._address()}. {_GO_ON}"
            )
        return self._counted

    def known(self):
        """The scheduler's information about its workers, by address. If the connection has just been lost, it
        is the earlier information, because Dask's client then ends its calls.
        """
        try:
            self._known = self._client.sync(self._ask, callback_timeout=SECONDS_UNTIL_LOST)
            self._answered = time.monotonic()
        except (OSError, AttributeError) as error:  # a TimeoutError, too; a closed client has no scheduler
            if isinstance(error, TimeoutError) or time.monotonic() - self._answered > SECONDS_UNTIL_LOST:
                raise Refusal(
                    f"The scheduler {self._address()} has not answered for {SECONDS_UNTIL_LOST:g} s; look "
                    f"after its host, or begin another by dask scheduler. {_GO_ON}"
                ) from error
        return self._known

    async def _ask(self):
        return (await self._client.scheduler.identity(n_workers=-1))["workers"]

    def _address(self):
        known = getattr(self._client, "scheduler", None)
        return getattr(known, "address", None) or "of dask"


def closed(client):
    """Close Dask's client, even if its scheduler does not answer any more."""
    with suppress(TimeoutError, OSError):
        client.close(timeout=_SECONDS_TO_CLOSE)
