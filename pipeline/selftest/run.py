"""The self-test: this process, a process without NumPy's extensions, and on request other processors."""

import tempfile
from collections.abc import Iterator

from fixedpipe.pipeline.selftest.checks import MOST_THREADS, Check, check_frames, usual_threads, ways
from fixedpipe.pipeline.selftest.processes import checks_elsewhere
from fixedpipe.pipeline.selftest.processors import (
    numpy_extensions,
    numpy_without_extensions,
    processor_features,
    processors,
)

_HERE = "on this processor"


def run_selftest(*, cpus: bool = False) -> Iterator[Check]:
    """The Checks, one after the other, as they are made.

    ``cpus`` also compiles the kernels for other processors, each in a process with its own cache, and draws
    on one to eight threads. It takes minutes.
    """
    threads = usual_threads()
    yield from check_frames(_HERE, ways(threads))
    yield from _without_extensions(threads)
    if cpus:
        for processor in processors():
            yield from _compiled_for(processor)


def _without_extensions(threads):
    extensions = numpy_extensions()
    where = f"with NumPy's {' '.join(extensions)} disabled" if extensions else "with a plain NumPy"
    if not extensions:
        yield Check(where, "", 0, left_out="NumPy uses no more of this processor than it was built for.")
        return
    yield from checks_elsewhere(where, (1, threads[-1]), numpy_without_extensions())


def _compiled_for(processor):
    where = f"compiled for {processor.name}, with a plain NumPy"
    if lacking := processor.lacking(processor_features()):
        yield Check(where, "", 0, left_out=f"this processor has no {', '.join(lacking)}.")
        return
    with tempfile.TemporaryDirectory(prefix="fixedpipe-selftest-") as folder:
        environment = {**processor.environment(), "NUMBA_CACHE_DIR": folder}
        yield from checks_elsewhere(where, range(1, MOST_THREADS + 1), environment)
