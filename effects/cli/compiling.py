"""The one long wait: kernels are compiled the first time they are needed."""

import click


def announce_compiling():
    """Say so where no kernel has been compiled yet. Call it before anything imports an engine."""
    from fixedpipe.pipeline.golden.provenance import kernels_are_cold

    if kernels_are_cold():
        click.echo(
            "Compiling the kernels for this machine. This happens once and takes a minute or two.", err=True
        )
