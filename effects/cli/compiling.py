"""The one long wait: kernels are compiled the first time they are needed."""

import click


def announce_compiling():
    """Say so where no kernel has been compiled yet. Call it before anything imports an engine."""
    from fixedpipe.pipeline.golden.provenance import kernels_are_cold

    if kernels_are_cold():
        click.echo(
            "Compiling the kernels for this machine, once. The first picture then took 34 seconds on an AMD "
            "EPYC (Zen 5), and 77 on an Intel Xeon at 2.1 GHz.",
            err=True,
        )
