"""``fixedpipe cache``: print where compiled kernels are stored, remove them, or move them elsewhere."""

import os
import subprocess
import sys
from pathlib import Path

import click

from fixedpipe.raster.kernel_folder import CHOSEN, clear, kept


@click.group(
    invoke_without_command=True, short_help="Print where kernels are kept; pack, unpack or remove them."
)
@click.pass_context
def cache(context):
    """Print where compiled kernels and stored results are kept, and how large they are.

    Results that take long to compute are stored. The environment variable NUMBA_CACHE_DIR names another
    folder. Run fixedpipe cache clear before you uninstall, because pip does not remove these files.
    """
    if context.invoked_subcommand is None:
        _say()


@cache.command("clear", short_help="Remove all stored kernels and results.")
def remove():
    """Remove all stored kernels and results, of every version. They are made again when needed."""
    before = kept()
    left = clear()
    gone = sum(size for _, size in before) - sum(size for _, size in kept())
    click.echo(f"Removed {len(before) - len(left)} of {len(before)} folders, {gone / 1e6:.0f} MB.")
    for folder, why in left:
        click.echo(f"{folder} stays: {why}. Let its owner remove it.", err=True)
    if left:
        raise click.exceptions.Exit(1)


@cache.command("pack", short_help="Write all kernels into one file, for another computer.")
@click.argument("file", type=click.Path(dir_okay=False))
@click.option(
    "--level",
    metavar="NAME",
    help="The level that a processor must have to use the pack: x86-64-v4 (AVX-512), x86-64-v3 (AVX2) or "
    "x86-64. Default: the highest level of this processor.",
)
def pack(file, level):
    """Write FILE, a pack of all kernels, compiled for a level of processors instead of for this one.

    A computer with the same version of fixedpipe, Python and Numba can unpack it, and compiles nothing. The
    command first compiles missing kernels, for a minute or more. It writes FILE after the self-test has drawn
    with the kernels.
    """
    from fixedpipe.effects.cli.kernel_packing import chosen_level, write_tested

    chosen = chosen_level(level)
    if chosen.is_compiled_for():
        write_tested(Path(file), chosen)
        return
    # Numba chooses the processor that it compiles for when it is imported.
    command = [sys.executable, "-m", "fixedpipe.effects.cli", "cache", "pack", file, "--level", chosen.name]
    status = subprocess.run(command, env=os.environ | chosen.environment(), check=False).returncode
    if status:
        raise click.exceptions.Exit(status)


@cache.command("unpack", short_help="Take the kernels of such a file.")
@click.argument("file", type=click.Path(dir_okay=False))
def unpack(file):
    """Use the kernels of FILE, a pack, in this installation, so that nothing is compiled.

    A pack is refused if it was made with other sources, or another Python, Numba or system. It is also
    refused if its kernels do not draw the accepted bits of the self-test. A pack is code: unpack only what
    you would install.
    """
    from fixedpipe.effects.cli.kernel_packing import keep_tested

    keep_tested(Path(file))


def _say():
    found = kept()
    for folder, size in found:
        click.echo(f"{size / 1e6:8.1f} MB  {folder}")
    if not found:
        click.echo(f"No compiled kernels are kept. `fixedpipe warmup` compiles them; {CHOSEN} names a place.")
