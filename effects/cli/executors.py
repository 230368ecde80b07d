"""The options of long work: --executor says where it is computed, and --manifest where it is stored."""

from contextlib import ExitStack, contextmanager

import click

from fixedpipe.pipeline.messages import count

executor_option = click.option(
    "--executor",
    metavar="WHERE",
    help="Where to compute: processes:N, dask:local, dask:tcp://HOST:PORT, mpi or loky:N "
    "(docs/scale.md). The results are the same.",
)


manifest_option = click.option(
    "--manifest",
    metavar="FILE",
    help="Keep finished work in FILE. If you give the same command again, it goes on from there.",
)


@contextmanager
def kept_work(executor, manifest, about, threads=None):
    """(Workers or None, Manifest or None) while the block runs.

    executor, manifest  the values of the options
    about               a description of the work, which the manifest stores

    Raises Refusal in the same cases as ``workers_of`` and ``Manifest``.
    """
    from fixedpipe.effects.tasks.manifest import Manifest

    with ExitStack() as held:
        known = held.enter_context(Manifest(manifest, about, with_files=True)) if manifest else None
        if known is not None and len(known):
            click.echo(f"{manifest} has {count(len(known), 'finished task')}.", err=True)
        yield held.enter_context(workers_of(executor, threads)), known


@contextmanager
def workers_of(text, threads=None):
    """The Workers that --executor names while the block runs, or None if it was not given. The error stream
    names the workers that are left out. Raises Refusal.
    """
    from fixedpipe.effects.tasks.executors import opened

    with opened(text, threads, lambda said: click.echo(said, err=True)) as workers:
        yield workers
