"""How far something is: a bar on a terminal, lines elsewhere, on the error stream."""

from contextlib import contextmanager
from functools import cache

import click

_LINES = 10  # where there is no terminal


@cache
def error_console():
    """The error stream as rich writes to it: one for all bars, which then know of each other."""
    from rich.console import Console

    return Console(stderr=True, highlight=False)


@contextmanager
def progress(steps):
    """A function that is called with a line of text as each of so many steps begins."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    done = 0
    if not error_console().is_terminal:

        def line(text):
            nonlocal done
            if done * _LINES // steps != (done - 1) * _LINES // steps:
                click.echo(f"{done + 1} of {steps}: {text}", err=True)
            done += 1

        yield line
        return
    columns = TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn()
    with Progress(*columns, TimeElapsedColumn(), console=error_console(), transient=True) as bar:
        task = bar.add_task("", total=steps)

        def step(text):
            nonlocal done
            bar.update(task, description=text[:60], completed=done)
            done += 1

        yield step
