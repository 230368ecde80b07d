"""``fixedpipe cache``: where compiled kernels are kept, and how to remove them."""

import click

from fixedpipe.raster.kernel_folder import CHOSEN, clear, kept


@click.group(invoke_without_command=True)
@click.pass_context
def cache(context):
    """Say where compiled kernels are kept, and how large they are.

    NUMBA_CACHE_DIR names another place. Remove them before you uninstall: pip leaves them where they are.
    """
    if context.invoked_subcommand is None:
        _say()


@cache.command("clear")
def remove():
    """Remove all kernels that are kept, of every version. They are compiled again when they are needed."""
    before = kept()
    left = clear()
    gone = sum(size for _, size in before) - sum(size for _, size in kept())
    click.echo(f"Removed {len(before) - len(left)} of {len(before)} folders, {gone / 1e6:.0f} MB.")
    for folder, why in left:
        click.echo(f"{folder} stays: {why}. Let its owner remove it.", err=True)
    if left:
        raise click.exceptions.Exit(1)


def _say():
    found = kept()
    for folder, size in found:
        click.echo(f"{size / 1e6:8.1f} MB  {folder}")
    if not found:
        click.echo(f"No compiled kernels are kept. `fixedpipe warmup` compiles them; {CHOSEN} names a place.")
