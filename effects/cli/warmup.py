"""``fixedpipe warmup``: compile all kernels now, so that no command waits for them later."""

import importlib
import pkgutil
import time

import click

from fixedpipe.effects.cli.compiling import announce_compiling


@click.command(short_help="Compile all kernels now, so that nothing waits for them later.")
@click.argument("ids", metavar="[ID …]", nargs=-1)
def warmup(ids):
    """Compile every kernel that is not yet compiled for this computer, and print where the kernels are kept.
    With IDs of figures or studies, compile only what these need.

    All kernels take 2 to 5 minutes, once. Two processes compile. Run the command after an install, or while
    a container is built. If several users share an install, its owner should run it; all of them then read
    these kernels. Exit status 1 if the kernels could not be kept.
    """
    from fixedpipe.effects.figures import FIGURES
    from fixedpipe.effects.refusal import choose
    from fixedpipe.effects.studies import STUDIES
    from fixedpipe.raster.kernel import CACHE_FOLDER
    from fixedpipe.raster.kernel_folder import kept

    for name in ids:
        choose("figure", name, FIGURES) if name not in STUDIES else STUDIES[name]  # this imports it
    began = time.monotonic()
    compile_all(of_imported=bool(ids))
    what = f"The kernels of {', '.join(ids)}" if ids else "All kernels"
    click.echo(f"{what} are compiled ({time.monotonic() - began:.0f} s).")
    size = dict(kept()).get(CACHE_FOLDER)
    if not size:
        click.echo(
            "They are not kept: no folder for them can be written. Name one in NUMBA_CACHE_DIR.", err=True
        )
        raise click.exceptions.Exit(1)
    click.echo(f"They are kept in {CACHE_FOLDER} ({size / 1e6:.0f} MB).")


def compile_all(*, of_imported=False):
    """Compile each kernel of one signature that is not compiled yet: those of every module, or with
    ``of_imported`` those of both engines and of the imported modules.
    """
    from fixedpipe.pipeline.native.background_compiling import compile_beside, make_ready
    from fixedpipe.raster.kernel import CACHE_FOLDER, make_all_ready
    from fixedpipe.raster.kernel_folder import kept

    announce_compiling(None)
    beside = None
    if CACHE_FOLDER in dict(kept()):  # else this process could not read the kernels of another
        # Another process compiles the missing engine. It runs as long as this variable holds it.
        beside = compile_beside("vector") or compile_beside("portable")
    for engine in ("vector", "portable") if of_imported else ():
        make_ready(engine)
    for name in () if of_imported else ("fixedpipe.raster", "fixedpipe.effects"):
        for module in pkgutil.walk_packages(importlib.import_module(name).__path__, f"{name}."):
            if not module.name.endswith(".__main__"):  # such a module runs a command
                _import(module.name)
    make_all_ready()
    del beside


def _import(name):
    """Import a module. If the package of an extra is missing, its module is skipped; no kernel there is
    needed here.
    """
    try:
        importlib.import_module(name)
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] == "fixedpipe":
            raise
