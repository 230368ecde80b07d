"""The one long wait: kernels are compiled when they are first needed, and again after a change of them."""

import time
from functools import cache, partial

import click

from fixedpipe.effects.cli.progress import error_console

_COLD = "Compiling the kernels for this machine. This happens once, and after a change of them."
_BESIDE = "Another process does it; until then pictures are drawn without them: slowly, the same bits."
_LEFT = "Done. Kernels for the next command are still being compiled; Ctrl-C leaves them to it."
_MORE = "Compiling kernels that nothing needed before."
COMPILING = "fixedpipe.compiling"  # of click's Context.meta: called when a command has done its work
_SECONDS = 5.0  # between lines, where there is no terminal


def said_now_and_then():
    """A function that is called with the name of each kernel that is compiled, and says some of them: lines,
    where there is no terminal.
    """
    line_at = -_SECONDS

    def say(kernel):
        nonlocal line_at
        if (now := time.monotonic()) - line_at >= _SECONDS:
            line_at = now
            click.echo(f"compiling {kernel}", err=True)

    return say


class _Shown:
    """What is being compiled: a bar on a terminal, lines elsewhere. ``said``: a sentence stands above it."""

    def __init__(self, said):
        self.said, self.bar, self.task, self.line_at = said, None, None, -_SECONDS

    def begin(self, kernel, done, needed):
        if not self.said:
            click.echo(_MORE, err=True)
            self.said = True
        if self.bar is None and error_console().is_terminal:
            self._start()
        if self.bar is not None:
            what = f"compiling {kernel}"
            self.bar.update(self.task, description=what, completed=done, total=needed)
        elif (now := time.monotonic()) - self.line_at >= _SECONDS:
            self.line_at = now
            click.echo(f"compiling kernel {done + 1} of {needed}: {kernel}", err=True)

    def end(self):
        if self.bar is not None:
            self.bar.stop()
            self.bar = None

    def _start(self):
        from rich.errors import LiveError
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

        columns = TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn()
        bar = Progress(*columns, TimeElapsedColumn(), console=error_console(), transient=True)
        try:
            bar.start()
        except LiveError:  # beside a figure's bar, where rich has one at a time
            return
        self.bar, self.task = bar, bar.add_task("", total=None)


@cache
def announce_compiling(engine="vector"):
    """Say so where kernels have still to be compiled, and show how many are. Call it before anything imports
    an engine; once is enough.

    engine    that most of the command is drawn by: where it has to be compiled, another process does, and
              this one does not wait (``fixedpipe.pipeline.native.background_compiling``); None: it waits
    """
    from fixedpipe.pipeline.golden.provenance import kernels_are_cold
    from fixedpipe.pipeline.native.background_compiling import compile_beside
    from fixedpipe.pipeline.native.compiling import watch_compiling
    from fixedpipe.raster.kernel import refused_packs

    cold = kernels_are_cold()
    compiling = compile_beside(engine) if engine else None
    for sentence in refused_packs() if cold or compiling else ():
        click.echo(sentence, err=True)
    if cold or compiling:
        click.echo(f"{_COLD} {_BESIDE}" if compiling else _COLD, err=True)
    shown = _Shown(said=cold or compiling is not None)
    watch_compiling(shown.begin, shown.end)
    if compiling:
        click.get_current_context().meta[COMPILING] = partial(_wait, compiling, shown)


def _wait(compiling, shown):
    """What a command does when its work is done: the next does not wait for what this one could compile."""
    click.echo(_LEFT, err=True)
    try:
        compiling.wait(shown.begin)
    except KeyboardInterrupt:
        pass
    finally:
        shown.end()
