"""The quick self-test before a picture is accepted: the fastest engines alone, once for an environment."""

import hashlib
import platform
from contextlib import suppress
from importlib import metadata
from pathlib import Path

import llvmlite.binding as llvm
import numba

from fixedpipe.pipeline.native.background_compiling import chosen_engine, covers_by_kernels
from fixedpipe.pipeline.selftest.checks import check_frames, usual_threads, ways
from fixedpipe.pipeline.selftest.digests import ACCEPTED
from fixedpipe.pipeline.selftest.processors import numpy_extensions
from fixedpipe.raster.kernel import CACHE_FOLDER


def failures() -> tuple[str, ...]:
    """A sentence for each frame that differs from its accepted digest; none differs in a sound environment.

    The fastest engines draw on one thread and on several. A success is stored beside the kernels, under a
    name that depends on versions, processor and sources, and is not tested again. A failure is.
    """
    kept = CACHE_FOLDER / f"selftest-{environment_digest()}.passed"
    if kept.exists():
        return ()
    threads = usual_threads()
    checks = check_frames("on this processor", ways((1, threads[-1]), (None,)))
    found = tuple(sentence for check in checks for sentence in check.failures)
    if not found:
        with suppress(OSError):  # The folder is full or gone: the test runs again next time.
            kept.touch()
    return found


def environment_digest() -> str:
    """A name for everything that bits could depend on: versions, processor, compilation target, sources."""
    versions = [metadata.version(name) for name in ("numpy", "numba", "llvmlite")]
    features = sorted(name for name, held in llvm.get_host_cpu_features().items() if held)
    compiled = numba.config.CPU_NAME, numba.config.CPU_FEATURES, CACHE_FOLDER.name
    drawn = chosen_engine(None), covers_by_kernels(), usual_threads()
    machine = platform.python_version(), platform.machine(), llvm.get_host_cpu_name(), features
    digest = hashlib.sha256(repr((versions, machine, compiled, numpy_extensions(), drawn)).encode())
    layers = Path(__file__).parents[2]
    for layer in ("pipeline", "raster"):
        for path in sorted((layers / layer).rglob("*.py")):
            digest.update(path.relative_to(layers).as_posix().encode() + path.read_bytes())
    digest.update((Path(__file__).parent / ACCEPTED).read_bytes())
    return digest.hexdigest()[:16]
