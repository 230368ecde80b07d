"""The option --executor, which everything long takes: where it is computed."""

from contextlib import contextmanager

import click

executor_option = click.option(
    "--executor",
    metavar="WHERE",
    help="Where it is computed: processes:N, dask:local, dask:tcp://HOST:PORT, mpi or loky:N "
    "(docs/scale.md). The results are the same.",
)


@contextmanager
def workers_of(text, threads=None):
    """The Workers that --executor names while the block runs, or None where it was not given. Workers that
    are left out are named on the error stream. Raises Refusal.
    """
    from fixedpipe.effects.tasks.executors import opened

    with opened(text, threads, lambda said: click.echo(said, err=True)) as workers:
        yield workers
