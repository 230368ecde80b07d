"""Waiting for another thread or process. What has not come after HANGS seconds is taken to hang."""

import time

HANGS = 300.0
_EACH = 0.01  # seconds between two looks


def until(found, what="what was waited for"):
    """The first true value of ``found()``. Raises AssertionError where it hangs."""
    end = time.monotonic() + HANGS
    while time.monotonic() < end:
        if value := found():
            return value
        time.sleep(_EACH)
    raise AssertionError(f"{what} did not come")
