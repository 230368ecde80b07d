"""The progress of long work: a bar on a terminal, lines elsewhere, on the error stream."""

from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from threading import Lock, Timer

import click

_LINES = 10  # how many lines are printed if there is no terminal
_SHORT = 2.0  # shorter work, in seconds, shows no progress


@cache
def error_console():
    """rich's Console for the error stream. All bars share it, so that they do not overwrite each other."""
    from rich.console import Console

    return Console(stderr=True, highlight=False)


@contextmanager
def progress_of_long(steps):
    """As ``progress``, for work that may be short: it shows nothing in the two seconds after the first step
    begins.
    """
    from rich.errors import LiveError

    step, text, begun, lock = None, "", 0, Lock()

    def show():
        nonlocal step
        with lock, suppress(LiveError):  # the bar of kernels is shown, and this rich shows only one bar
            step = shown.enter_context(progress(steps, begun - 1))
            step(text)

    def told(what):
        nonlocal text, begun
        with lock:
            text, begun = what, begun + 1
            if step:
                step(what)
        if begun == 1:
            timer.start()

    timer = Timer(_SHORT, show)
    timer.daemon = True
    with ExitStack() as shown:
        try:
            yield told
        finally:
            timer.cancel()
            if begun:
                timer.join()


@contextmanager
def progress(steps, done=0):
    """Yields a function to call with a line of text when each of ``steps`` steps begins. ``done``: how many
    steps are already finished.
    """
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    if not error_console().is_terminal:
        first = done

        def line(text):
            nonlocal done
            if done == first or done * _LINES // steps != (done - 1) * _LINES // steps:
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
