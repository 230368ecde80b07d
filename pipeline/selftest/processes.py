"""Checks in another process, whose Numba and NumPy read its variables when they are imported."""

import json
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict

from fixedpipe.pipeline.selftest.checks import Check

_WORDS = 400  # characters of a failed process's last output


def to_json(checks: Sequence[Check]) -> str:
    """Checks as one line."""
    return json.dumps([asdict(check) for check in checks])


def checks_of(text: str) -> tuple[Check, ...]:
    """The Checks of such a line."""
    return tuple(Check(**{**line, "failures": tuple(line["failures"])}) for line in json.loads(text))


def checks_elsewhere(where: str, threads: Sequence[int], environment: Mapping[str, str]) -> tuple[Check, ...]:
    """The Checks that ``python -m fixedpipe.pipeline.selftest`` makes with these variables."""
    command = [sys.executable, "-m", "fixedpipe.pipeline.selftest", where, *map(str, threads)]
    run = subprocess.run(
        command, env=os.environ | environment, capture_output=True, text=True, check=False
    )  # Compiling takes minutes on a busy machine, so no time limit can show that it hangs.
    if run.returncode:
        last = " ".join(run.stderr.split())[-_WORDS:] or "it said nothing"
        failure = f"The process {where} ended with status {run.returncode}: {last}"
        return (Check(where, "", 0, (failure,)),)
    return checks_of(run.stdout.splitlines()[-1])
