"""Messages about compiling. Kernels are compiled when they are first needed, and again when they change."""

import time
from functools import cache, partial

import click

from fixedpipe.effects.cli.progress import error_console

_COLD = "Compiling the kernels for this machine. This happens once, and after a change of them."
_BESIDE = "Another process does it; until then pictures are drawn without them: slowly, the same bits."
_LEFT = "Done. Kernels for the next command are still being compiled; Ctrl-C leaves them to it."
_MORE = "Compiling kernels that nothing needed before."
COMPILING = "fixedpipe.compiling"  # key in click's Context.meta: a function to call after a command's work
_SECONDS = 5.0  # between lines, if there is no terminal


def said_now_and_then():
    """A function to call with the name of each kernel that is compiled. It prints some of the names as lines,
    for use without a terminal.
    """
    line_at = -_SECONDS

    def say(kernel):
        nonlocal line_at
        if (now := time.monotonic()) - line_at >= _SECONDS:
            line_at = now
            click.echo(f"compiling {kernel}", err=True)

    return say


class _Shown:
    """Shows which kernel is compiled: a bar on a terminal, otherwise lines. ``said``: whether a sentence was
    printed above it.
    """

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
        except LiveError:  # a figure's bar is shown, and this version of rich shows only one bar
            return
        self.bar, self.task = bar, bar.add_task("", total=None)


@cache
def announce_compiling(engine="vector"):
    """If kernels are not compiled yet, print a sentence, and show how many are compiled. Call it once, before
    any module imports an engine.

    engine    the engine that draws most of the command. If it is not compiled, another process compiles it,
              and this one does not wait (``fixedpipe.pipeline.native.background_compiling``); None: it waits
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
    """After a command's work, wait until its kernels are compiled, so that the next command need not wait."""
    click.echo(_LEFT, err=True)
    try:
        compiling.wait(shown.begin)
    except KeyboardInterrupt:
        pass
    finally:
        shown.end()
