"""Write packs of compiled kernels, and install them. The self-test draws with each pack first."""

import os
import shutil
import tempfile
from contextlib import contextmanager
from pathlib import Path

import click

from fixedpipe.effects.cli.warmup import compile_all
from fixedpipe.effects.refusal import Refusal, choose, refusals
from fixedpipe.effects.reports.files import writable_file
from fixedpipe.pipeline.messages import count
from fixedpipe.pipeline.selftest.processes import checks_elsewhere
from fixedpipe.raster.kernel import CACHE_FOLDER, STATE, compiled_for
from fixedpipe.raster.kernel_folder import CHOSEN
from fixedpipe.raster.kernel_levels import LEVELS, ON_X86
from fixedpipe.raster.kernel_packs import SUFFIX, Pack, write_pack

# If one of these variables is set, a process compiles for the processor that it names and reads no pack.
_NAMED = "NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"


def chosen_level(name):
    """The Level of a name, or without one the highest of this processor. Raises Refusal if the processor does
    not have this level.
    """
    levels = {level.name: level for level in LEVELS}
    if not ON_X86:
        raise Refusal("Packs are for levels of x86-64, which this processor is not; it compiles for itself.")
    level = choose("level", name, levels) if name else next(level for level in LEVELS if not level.lacking())
    if lacking := level.lacking():
        raise Refusal(
            f"Kernels for {level.name} cannot be tested here, as this processor has no {', '.join(lacking)}; "
            "pack them on one that has."
        )
    return level


def write_tested(path, level):
    """Compile missing kernels, and write a pack for a Level. This process must compile for that Level."""
    path = writable_file(path)
    compile_all()
    kernels = compiled_for(level)
    if not kernels:
        raise Refusal(
            "No folder for compiled kernels can be written, so none can be packed; name one in "
            "NUMBA_CACHE_DIR."
        )
    with _alone() as folder:
        unfinished = folder / f"{level.name}{SUFFIX}"
        write_pack(unfinished, STATE, level.name, kernels)
        _test(f"with the kernels of {path}")
        shutil.copyfile(unfinished, path)
    size = path.stat().st_size
    click.echo(f"{path} has {count(len(kernels), 'kernel')} for {level.name} ({size / 1e6:.1f} MB).")


def keep_tested(path):
    """Check a pack, draw the self-test with it, and store it in the folder of this installation's kernels."""
    with refusals():
        pack = Pack(path)
        pack.check_fits(STATE)
        pack.check_runs()
        pack.check_whole()
    with _alone() as folder:
        shutil.copyfile(path, folder / f"{pack.level.name}{SUFFIX}")
        _test(f"with the kernels of {path}")
    kept = CACHE_FOLDER / f"{pack.level.name}{SUFFIX}"
    unfinished = kept.with_suffix(f".{os.getpid()}.tmp")
    try:
        shutil.copyfile(path, unfinished)
        unfinished.replace(kept)
    except OSError as error:
        raise Refusal(f"The pack cannot be kept in {CACHE_FOLDER}: {error.strerror}.") from error
    finally:
        unfinished.unlink(missing_ok=True)
    click.echo(f"{count(len(pack), 'kernel')} for {pack.level.name} kept in {kept}.")


@contextmanager
def _alone():
    """Yields an empty folder of kernels. Inside the block other processes look for kernels only there."""
    before = {name: os.environ.pop(name) for name in (CHOSEN, *_NAMED) if name in os.environ}
    try:
        with tempfile.TemporaryDirectory(prefix="fixedpipe-pack-") as base:
            os.environ[CHOSEN] = base
            folder = Path(base) / "kernels" / STATE
            folder.mkdir(parents=True)
            yield folder
    finally:
        os.environ.pop(CHOSEN, None)
        os.environ.update(before)


def _test(where):
    """Raise Refusal if the self-test, in a process of its own, does not draw the accepted bits."""
    checks = checks_elsewhere(where, (1, 2), {})
    if failures := [sentence for check in checks for sentence in check.failures]:
        raise Refusal(
            f"{count(len(failures), 'drawing')} of the self-test went wrong, drawn {where}: {failures[0]}"
        )
