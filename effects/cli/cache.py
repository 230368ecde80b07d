"""``fixedpipe cache``: where compiled kernels are kept, how to remove them, how to take them elsewhere."""

import os
import subprocess
import sys
from pathlib import Path

import click

from fixedpipe.raster.kernel_folder import CHOSEN, clear, kept


@click.group(invoke_without_command=True)
@click.pass_context
def cache(context):
    """Say where compiled kernels are kept, and results that take long to compute, and how large they are.

    NUMBA_CACHE_DIR names another place. Remove them before you uninstall: pip leaves them where they are.
    """
    if context.invoked_subcommand is None:
        _say()


@cache.command("clear")
def remove():
    """Remove all kernels and results that are kept, of every version. They are made again when needed."""
    before = kept()
    left = clear()
    gone = sum(size for _, size in before) - sum(size for _, size in kept())
    click.echo(f"Removed {len(before) - len(left)} of {len(before)} folders, {gone / 1e6:.0f} MB.")
    for folder, why in left:
        click.echo(f"{folder} stays: {why}. Let its owner remove it.", err=True)
    if left:
        raise click.exceptions.Exit(1)


@cache.command("pack")
@click.argument("file", type=click.Path(dir_okay=False))
@click.option(
    "--level",
    metavar="NAME",
    help="x86-64-v4 (AVX-512), x86-64-v3 (AVX2) or x86-64: what a processor must have to use it; else the "
    "highest level that this one has.",
)
def pack(file, level):
    """Write FILE, a pack: all kernels, compiled for a level of processors instead of for this one.

    A computer with the same version of fixedpipe, Python and Numba unpacks it and compiles nothing. What is
    missing is compiled first, for a minute or more. The self-test draws with the kernels before FILE is
    written.
    """
    from fixedpipe.effects.cli.kernel_packing import chosen_level, write_tested

    chosen = chosen_level(level)
    if chosen.is_compiled_for():
        write_tested(Path(file), chosen)
        return
    # Numba reads for which processor it compiles when it is imported.
    command = [sys.executable, "-m", "fixedpipe.effects.cli", "cache", "pack", file, "--level", chosen.name]
    status = subprocess.run(command, env=os.environ | chosen.environment(), check=False).returncode
    if status:
        raise click.exceptions.Exit(status)


@cache.command("unpack")
@click.argument("file", type=click.Path(dir_okay=False))
def unpack(file):
    """Take the kernels of FILE, a pack, for those of this installation; nothing is compiled then.

    A pack of other sources, another Python, another version of Numba or another system is refused, and so is
    one whose kernels do not draw the accepted bits of the self-test. A pack is code: unpack only what you
    would install.
    """
    from fixedpipe.effects.cli.kernel_packing import keep_tested

    keep_tested(Path(file))


def _say():
    found = kept()
    for folder, size in found:
        click.echo(f"{size / 1e6:8.1f} MB  {folder}")
    if not found:
        click.echo(f"No compiled kernels are kept. `fixedpipe warmup` compiles them; {CHOSEN} names a place.")
