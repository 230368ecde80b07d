"""``fixedpipe conformance``: redraw captures of a real chip and count the pixels that agree."""

import json
import os
import sys
import warnings
from contextlib import contextmanager
from itertools import groupby
from pathlib import Path

import click

from fixedpipe.effects.cli.executors import executor_option, kept_work, manifest_option
from fixedpipe.effects.cli.options import given_options, refuse_beside
from fixedpipe.effects.cli.progress import error_console

_HOW = (
    "Clone https://github.com/abaire/nxdk_pgraph_tests_golden_results and give its folder `results`, "
    "or set FIXEDPIPE_CAPTURES to it."
)


@click.command(short_help="Redraw captures of a real NV2A and count equal pixels.")
@click.argument("folder", required=False)
@click.option(
    "--suite",
    "suites",
    multiple=True,
    metavar="NAME",
    help="Redraw only this suite. May be given several times.",
)
@click.option("--case", "text", metavar="TEXT", default="", help="Redraw only cases with TEXT in their name.")
@click.option(
    "--list", "list_only", is_flag=True, help="Print the suites that can be redrawn, and draw nothing."
)
@click.option(
    "--inputs",
    metavar="DIR",
    help="Folder of the textures and meshes that some cases need. Default: what the variable "
    "FIXEDPIPE_INPUTS names.",
)
@click.option("--json", "json_file", metavar="FILE", help="Also write the results as a JSON list.")
@click.option("--html", "html_file", metavar="FILE", help="Write a page that shows every difference.")
@click.option(
    "--threads",
    type=click.IntRange(min=1),
    metavar="N",
    help="How many cases to draw at a time. Any number gives the same bits.",
)
@click.option("--jobs", type=click.IntRange(min=1), metavar="N", help="Short for --executor processes:N.")
@executor_option
@manifest_option
@click.option("--other", metavar="DIR", help="Also compare another renderer's pictures, DIR/SUITE/CASE.png.")
@click.option(
    "--page", "page_file", metavar="FILE", help="With --other: write the counts of both renderers as a page."
)
@click.option(
    "--answers",
    metavar="FILE",
    help="Read what gl_questions.c printed on a real board (- for standard input), and print which facts it "
    "confirms.",
)
@click.option(
    "--explain", is_flag=True, help="For every case that is not exact, print what drew its worst pixel."
)
@click.option(
    "--discriminates",
    metavar="RULE",
    help="Print which captures distinguish an open rule from its alternative. list: print the rules.",
)
def conformance(
    folder,
    suites,
    text,
    list_only,
    inputs,
    json_file,
    html_file,
    threads,
    jobs,
    executor,
    manifest,
    other,
    page_file,
    answers,
    explain,
    discriminates,
):
    """Redraw the captures in FOLDER on the NV2A, and print how many of the compared pixels are equal.

    FOLDER holds SUITE/CASE.png, 640x480, like the folder `results` of nxdk_pgraph_tests_golden_results. The
    default is the folder that the environment variable FIXEDPIPE_CAPTURES names. Text in the pictures is not
    compared. Exit status 1: a case could not be redrawn because of an error.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.conformance.captures import find_captures
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.reports.files import writable_file, write_whole

    if list_only:
        refuse_beside(click.get_current_context(), "--list")
        _list_suites()
        return
    if discriminates == "list":
        from fixedpipe.effects.cli.conformance_rules import list_rules

        list_rules()
        return
    if answers is not None:
        from fixedpipe.effects.cli.conformance_answers import tell_answers

        others = set(given_options(click.get_current_context())) - {"--answers", "--json"}
        if others:
            raise Refusal(
                f"--answers reads a board's answers alone; leave {' and '.join(sorted(others))} out."
            )
        tell_answers(answers, json_file)
        return
    folder = _folder_of_captures(folder)
    inputs = _folder_of_inputs(inputs, folder)
    captures = find_captures(folder, suites, text)
    if page_file and (not other or discriminates):
        raise Refusal(
            "--page is another renderer's scoreboard; give --other DIR, the folder of its pictures."
        )
    written = {"--json": json_file, "--html": html_file, "--page": page_file}
    _refuse_one_file(written)
    json_path, html_path, page_path = (writable_file(name) if name else None for name in written.values())
    other = _folder_of_other(other)
    if (jobs is not None) + (threads is not None) + (executor is not None) > 1:
        raise Refusal("--jobs, --threads and --executor all say how many cases at a time; give one of them.")
    if manifest and threads:
        raise Refusal("With --manifest --threads is of no use; give --executor processes:N, or leave it out.")
    executor = f"processes:{jobs}" if jobs else executor

    announce_compiling()
    from fixedpipe.effects.conformance.case import Inputs
    from fixedpipe.effects.conformance.redraw import known_suites
    from fixedpipe.effects.conformance.run import Totals, compare_all
    from fixedpipe.effects.conformance.scoreboard import reader, row_of
    from fixedpipe.effects.conformance.tasks import compare_by
    from fixedpipe.effects.reports.conformance import Page, record_of
    from fixedpipe.effects.reports.scoreboard import score_record, scoreboard_html, scoreboard_text
    from fixedpipe.effects.reports.scoreboard_page import ScoreboardPage
    from fixedpipe.pipeline.validation.walk import DisabledTexture

    warnings.simplefilter("ignore", DisabledTexture)  # the captures show what a chip draws in this case
    modules, inputs = known_suites(), Inputs(inputs)
    if discriminates:
        if html_file or other or explain or executor or threads or manifest:
            raise Refusal(
                "--discriminates counts pixels by two rules, one case at a time; --html, --other, --explain, "
                "--jobs, --threads, --executor and --manifest are of no use to it. Leave them out."
            )
        from fixedpipe.effects.cli.conformance_rules import tell_distinctions

        tell_distinctions(discriminates, captures, modules, inputs, json_path, _progress)
        return
    page, records, total, failed = Page() if html_path else None, [], Totals(), 0
    rows, read = {}, reader(other) if other else None
    published = ScoreboardPage(other.resolve().name) if page_path else None
    kept = kept_work(executor, manifest, "captures of the NV2A")
    with kept as (workers, known), _progress(len(captures)) as (say, step):
        if workers or known is not None:
            comparisons = compare_by(workers, known, captures, inputs)
        else:
            comparisons = compare_all(captures, modules, inputs, threads)
        for suite, cases in groupby(comparisons, lambda c: c.suite):
            of_suite = Totals()
            for case in cases:
                if suite in modules:
                    say(_line(case))
                    if explain and case.covered and not case.exact:
                        say(_explained(case, modules[suite], inputs))
                of_suite, failed = of_suite + Totals.of(case), failed + case.failed
                record = record_of(case)
                if read and case.covered:
                    theirs = read(suite, case.name)
                    row = rows[suite, case.name] = row_of(case, theirs)
                    if published:
                        published.add(case, row, theirs)
                    record |= score_record(row)
                records.append(record)
                if page:
                    page.add(case)
                step(f"{case.suite}/{case.name}")
            say(f"{suite}: {of_suite if suite in modules else 'the suite is not covered'}\n")
            total = total + of_suite
    if json_path:
        write_whole(json_path, (json.dumps(records, indent=1) + "\n").encode())
    if html_path:
        write_whole(html_path, page.text(total, scoreboard_html(rows, other) if rows else "").encode())
        click.echo(f"open {html_path}", err=True)
    if page_path:
        write_whole(page_path, published.text().encode())
        click.echo(f"open {page_path}", err=True)
    if failed:
        click.echo(f"{failed} case{'s' * (failed != 1)} ended with an error.", err=True)
    if rows:
        click.echo(scoreboard_text(rows))
    click.echo(str(total))
    sys.exit(1 if failed else 0)


def _refuse_one_file(written):
    """Raise Refusal if two options name the same file. ``written``: files, or None, by option."""
    from fixedpipe.effects.refusal import Refusal

    seen = {}
    for option, name in written.items():
        if name and (first := seen.setdefault(Path(name).resolve(), option)) != option:
            raise Refusal(f"{first} and {option} both name {name}; give each a file of its own.")


def _folder_of_other(other):
    from fixedpipe.effects.refusal import Refusal

    if other is None or Path(other).is_dir():
        return other and Path(other)
    raise Refusal(
        f"There is no folder {other!r}; --other takes one with SUITE/CASE.png, as the captures lie."
    )


def _explained(case, module, inputs):
    """Text on the worst pixel of a case that is not exact: the last command that changed it, and stages."""
    import numpy as np

    from fixedpipe.effects.conformance.case import HEIGHT, WIDTH
    from fixedpipe.pipeline.inspection.inspect import history
    from fixedpipe.pipeline.inspection.recording import record
    from fixedpipe.pipeline.profiles import NV2A

    made = module.case(case.name, inputs)
    apart = np.abs(case.ours.astype(np.int16) - case.theirs).max(axis=2) * case.compared
    y, x = (int(n) for n in np.unravel_index(int(apart.argmax()), apart.shape))
    frame = record(made.commands, NV2A, WIDTH, HEIGHT, depth_bits=made.depth_bits)
    if frame.steps and frame.steps[-1].surface is not None:
        return f"  worst at ({x}, {y}): the frame ends in a pbuffer"
    told = [t for t in history(frame, (x, y)).touched if t.before != t.after]
    ours, theirs = (" ".join(map(str, picture[y, x].tolist())) for picture in (case.ours, case.theirs))
    head = f"  worst at ({x}, {y}): ours {ours}, the chip's {theirs}"
    if not told:
        return f"{head}; no command changed it"
    last = told[-1]
    lines = [f"{head}; last changed by command {last.number}, {last.kind} {last.label!r}"]
    for stage in last.fragments[-1].stages if last.fragments else ():
        made_there = "; ".join(f"{q.name} {' '.join(map(str, q.codes or q.values))}" for q in stage.made[:4])
        lines.append(f"    {stage.title}: {made_there}")
    return "\n".join(lines)


def _line(case):
    """The line of one case: how many pixels agree, and if not all, why."""
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
    """The given folder, or the one of the environment variable. Raises Refusal if it does not exist."""
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
    """The folder of textures and meshes: the given one, the one of the environment variable, or one near the
    captures; None if there is none.
    """
    from fixedpipe.effects.refusal import Refusal

    given = inputs or os.environ.get("FIXEDPIPE_INPUTS")
    if given and not Path(given).is_dir():
        raise Refusal(f"There is no folder {given!r}. Give the textures and meshes of nxdk_pgraph_tests.")
    found = Path(given) if given else folder.resolve() / ".." / ".." / "inputs"
    return found if found.is_dir() else None


@contextmanager
def _progress(cases):
    """Yields two functions. One prints a line. The other names the case that was just compared, on the
    progress bar of a terminal.
    """
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

        # If the output is piped, it goes to the pipe. On the same terminal it must not overwrite the bar.
        say = above_the_bar if sys.stdout.isatty() else click.echo
        yield say, lambda text: progress.update(task, description=text, advance=1)
