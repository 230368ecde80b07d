"""``fixedpipe conformance``: redraw captures of a real chip and count the pixels that agree."""

import json
import os
import sys
import warnings
from contextlib import contextmanager
from itertools import groupby
from pathlib import Path

import click

from fixedpipe.effects.cli.options import refuse_beside
from fixedpipe.effects.cli.progress import error_console

_HOW = (
    "Clone https://github.com/abaire/nxdk_pgraph_tests_golden_results and give its folder `results`, "
    "or set FIXEDPIPE_CAPTURES to it."
)


@click.command(short_help="Redraw captures of a real NV2A and count equal pixels.")
@click.argument("folder", required=False)
@click.option("--suite", "suites", multiple=True, metavar="NAME", help="Only this suite; repeat for several.")
@click.option("--case", "text", metavar="TEXT", default="", help="Only cases with TEXT in their name.")
@click.option("--list", "list_only", is_flag=True, help="Name the suites that can be redrawn and end.")
@click.option("--inputs", metavar="DIR", help="Textures and meshes of some cases (or FIXEDPIPE_INPUTS).")
@click.option("--json", "json_file", metavar="FILE", help="Write the results as a JSON list as well.")
@click.option("--html", "html_file", metavar="FILE", help="Write a page that shows every difference.")
@click.option(
    "--threads", type=click.IntRange(min=1), metavar="N", help="Cases at a time; any number, the same bits."
)
def conformance(folder, suites, text, list_only, inputs, json_file, html_file, threads):
    """Redraw the captures in FOLDER (or FIXEDPIPE_CAPTURES) on the NV2A; print pixels equal / compared.

    FOLDER holds SUITE/CASE.png, 640x480: the folder `results` of nxdk_pgraph_tests_golden_results. Text in
    the pictures is not compared. Exit status 1: a case could not be redrawn because of an error.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.conformance.captures import find_captures
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.reports.files import writable_file, write_whole

    if list_only:
        refuse_beside(click.get_current_context(), "--list")
        _list_suites()
        return
    folder = _folder_of_captures(folder)
    inputs = _folder_of_inputs(inputs, folder)
    captures = find_captures(folder, suites, text)
    if json_file and html_file and Path(json_file).resolve() == Path(html_file).resolve():
        raise Refusal(f"--json and --html both name {json_file}; give each a file of its own.")
    json_path, html_path = (writable_file(name) if name else None for name in (json_file, html_file))

    announce_compiling()
    from fixedpipe.effects.conformance.case import Inputs
    from fixedpipe.effects.conformance.redraw import known_suites
    from fixedpipe.effects.conformance.run import Totals, compare_all
    from fixedpipe.effects.reports.conformance import Page, record_of
    from fixedpipe.pipeline.validation.walk import DisabledTexture

    warnings.simplefilter("ignore", DisabledTexture)  # captures are what a chip drew of it
    page, records, total, failed = Page() if html_path else None, [], Totals(), 0
    modules = known_suites()
    with _progress(len(captures)) as (say, step):
        comparisons = compare_all(captures, modules, Inputs(inputs), threads)
        for suite, cases in groupby(comparisons, lambda c: c.suite):
            of_suite = Totals()
            for case in cases:
                if suite in modules:
                    say(_line(case))
                of_suite, failed = of_suite + Totals.of(case), failed + case.failed
                records.append(record_of(case))
                if page:
                    page.add(case)
                step(f"{case.suite}/{case.name}")
            say(f"{suite}: {of_suite if suite in modules else 'the suite is not covered'}\n")
            total = total + of_suite
    if json_path:
        write_whole(json_path, (json.dumps(records, indent=1) + "\n").encode())
    if html_path:
        write_whole(html_path, page.text(total).encode())
        click.echo(f"open {html_path}", err=True)
    if failed:
        click.echo(f"{failed} case{'s' * (failed != 1)} ended with an error.", err=True)
    click.echo(str(total))
    sys.exit(1 if failed else 0)


def _line(case):
    """What is said of one case: its pixels, and why if not all agree."""
    if not case.covered:
        said = f"{'error' if case.failed else 'not covered'}: {case.note}"
    else:
        said = f"{case.pixels_equal} / {case.pixels_compared}"
        if case.note and not case.exact:
            said += f"  {case.note}"
    return f"{case.suite}/{case.name}: {said}"


def _list_suites():
    from fixedpipe.effects.conformance.redraw import known_suites

    for suite, module in sorted(known_suites().items()):
        names = module.names()
        click.echo(f"{suite:32s} {len(names):5d} cases: {names[0]}{' …' * (len(names) > 1)}")


def _folder_of_captures(folder):
    """The folder given, or the environment's; Refusal where it is none."""
    from fixedpipe.effects.refusal import Refusal

    folder = folder or os.environ.get("FIXEDPIPE_CAPTURES")
    if not folder:
        raise Refusal(f"No captures were given. {_HOW}")
    try:
        if Path(folder).is_dir():
            return Path(folder)
    except ValueError:  # a null character
        pass
    raise Refusal(f"There is no folder {folder!r}. {_HOW}")


def _folder_of_inputs(inputs, folder):
    """Where textures and meshes lie: as given, the environment's, or beside the captures; None: nowhere."""
    from fixedpipe.effects.refusal import Refusal

    given = inputs or os.environ.get("FIXEDPIPE_INPUTS")
    if given and not Path(given).is_dir():
        raise Refusal(f"There is no folder {given!r}. Give the textures and meshes of nxdk_pgraph_tests.")
    found = Path(given) if given else folder.resolve() / ".." / ".." / "inputs"
    return found if found.is_dir() else None


@contextmanager
def _progress(cases):
    """Two functions: print a line; name the case just compared, on a terminal's progress bar."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    console = error_console()
    if not console.is_terminal:
        yield click.echo, lambda text: None
        return
    columns = BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TextColumn("{task.description}")
    with Progress(*columns, console=console, transient=True, redirect_stdout=False) as progress:
        task = progress.add_task("", total=cases)

        def above_the_bar(line):
            console.print(line, markup=False, soft_wrap=True)

        # What is piped stays in the pipe; what goes to the same terminal must not run into the bar.
        say = above_the_bar if sys.stdout.isatty() else click.echo
        yield say, lambda text: progress.update(task, description=text, advance=1)
