"""``fixedpipe golden``: record, check, review and accept the golden pictures of a project's tests."""

import subprocess
import sys
from pathlib import Path

import click

_ROOT = click.option(
    "--root", metavar="DIR", help="The project's folder. Default: the nearest one with a .golden folder."
)
_PYTEST = click.argument("arguments", nargs=-1, type=click.UNPROCESSED, metavar="[-- PYTEST ARGUMENTS]")
PICTURES, REFUSED, TESTS = 1, 2, 3  # exit statuses


@click.group(short_help="Golden pictures of your tests: record, check, review, accept.")
def golden():
    """Golden pictures for a project's tests, whatever draws them. The pytest fixture ``golden`` compares
    pixels with accepted ones. With these commands you record, check, review and accept the pictures.

    Exit status: 0 if all pictures are golden; 1 if a picture differs, is new, missing or an orphan; 2 if the
    command cannot do what was asked. It is 3 if all pictures are golden, and tests fail for other reasons.
    """


def _place(root):
    from fixedpipe.effects.refusal import refusals
    from fixedpipe.pipeline.golden.candidates import workplace

    with refusals():
        return Path(root).resolve() if root else workplace(Path.cwd())


def _run_pytest(*arguments, silent=False):
    """Run pytest, and return its exit status: 0 if all tests passed, 1 if tests failed, 5 if there were none.
    Raises Refusal for another status.

    ``silent``: pytest's output is printed only in the case of such a Refusal.
    """
    from importlib.util import find_spec

    from fixedpipe.effects.refusal import Refusal

    if find_spec("pytest") is None:
        raise Refusal("pytest is not installed here; install fixedpipe[pytest].")
    out = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT} if silent else {}
    done = subprocess.run([sys.executable, "-m", "pytest", *arguments], check=False, **out)
    status = done.returncode
    if status not in (0, 1, 5):
        if silent:
            click.echo(done.stdout.decode(errors="replace"), err=True)
        raise Refusal(
            f"pytest ended with the status {status}, before its tests ended; what it printed says why."
        )
    return status


@golden.command(short_help="Run pytest, and accept new pictures.")
@_PYTEST
def record(arguments):
    """Run pytest, and accept the pictures that have no golden one yet. Those that differ stay as they are."""
    from fixedpipe.pipeline.golden.candidates import FOLDER

    status = _run_pytest("--golden-record", *arguments)
    root = next((folder for folder in (Path.cwd(), *Path.cwd().parents) if (folder / FOLDER).is_dir()), None)
    _end(status, [] if root is None else _results(root))


@golden.command(short_help="Run pytest, and report each picture's result.")
@click.option("--no-run", is_flag=True, help="Run no test; report on the last run of pytest.")
@click.option(
    "--json",
    "json_file",
    metavar="FILE",
    help="Write each picture's result and the paths of all written files.",
)
@click.option("--junit", metavar="FILE", help="Write the same as JUnit XML, with a case for each picture.")
@_ROOT
@_PYTEST
def check(no_run, json_file, junit, root, arguments):
    """Run pytest, and report each picture's result: here, as JSON or as JUnit XML."""
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.reports.files import writable_file, write_whole
    from fixedpipe.effects.reports.golden.results import results_json, results_junit

    if no_run and arguments:
        raise Refusal(
            "--no-run does not run pytest, so arguments of pytest do nothing; leave them or --no-run out."
        )
    junit_path, json_path = (name and writable_file(name) for name in (junit, json_file))
    status = 0 if no_run else _run_pytest(*arguments)
    root = _place(root)
    found = _results(root)
    if junit:
        write_whole(junit_path, results_junit(found))
    if json_file:
        written = [path for path in (junit, json_file) if path]
        write_whole(json_path, results_json(root, found, written).encode())
    _tell(found)
    _end(status, found)


def _results(root):
    from fixedpipe.effects.refusal import refusals
    from fixedpipe.effects.reports.golden.results import results

    with refusals():
        return results(root)


def _tell(found):
    from fixedpipe.effects.reports.golden.results import EXCUSED, GOOD, STATUSES

    for entry in found:
        if entry["status"] not in GOOD or (entry["told"] and entry["status"] != EXCUSED):
            click.echo(f"{entry['status']:8} {entry['name']}")
            for line in entry["told"].splitlines():
                click.echo(f"         {line.strip()}")
    counts = ((status, sum(e["status"] == status for e in found)) for status in STATUSES)
    click.echo("pictures: " + (", ".join(f"{count} {status}" for status, count in counts if count) or "none"))


def _end(status, found):
    from fixedpipe.effects.reports.golden.results import GOOD

    pictures = any(entry["status"] not in GOOD for entry in found)
    click.get_current_context().exit(PICTURES if pictures else TESTS if status == 1 else 0)


@golden.command(short_help="Accept pictures that the tests drew.")
@click.argument("names", nargs=-1, metavar="NAME…")
@click.option("--all", "everything", is_flag=True, help="Accept every picture that waits.")
@click.option(
    "-k", "expression", metavar="EXPRESSION", help="Accept the pictures of the tests that pytest -k chooses."
)
@_ROOT
def accept(names, everything, expression, root):
    """Accept pictures that the tests drew, so that they become golden.

    NAME is a picture's name as the tests and the review print it. In NAME, * stands for any characters and ?
    for one.
    """
    from fixedpipe.effects.cli.golden_choice import chosen_candidates
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.pipeline.golden.accepting import accept_where_sound
    from fixedpipe.pipeline.golden.candidates import read_candidates

    root = _place(root)
    with refusals():
        candidates = read_candidates(root)
        if not candidates:
            raise Refusal(
                "No picture waits to be accepted: all that the tests drew is golden. Run pytest first."
            )
        for candidate in chosen_candidates(candidates, names, everything, expression, root, _run_pytest):
            for sentence in accept_where_sound(root, [candidate]):
                click.echo(sentence)


@golden.command("import", short_help="Make pictures of pytest-mpl, pytest-regressions or syrupy golden.")
@click.argument("folder", metavar="DIR")
@click.option("--into", "module", required=True, metavar="FILE", help="The test module that draws them.")
def import_(folder, module):
    """Make the baseline pictures of pytest-mpl, pytest-regressions or syrupy golden.

    It takes the PNG files in DIR that have the name of a test of the module FILE. A picture that is already
    golden stays as it is.
    """
    from fixedpipe.effects.cli.golden_import import import_baselines

    whole = import_baselines(folder, module, _run_pytest)
    click.get_current_context().exit(0 if whole else PICTURES)


@golden.command(short_help="Print the golden pictures that no test draws any more.")
@click.option("--remove", is_flag=True, help="Remove the orphans from their stores, with their PNG files.")
@_ROOT
def orphans(remove, root):
    """Print the golden pictures that no test drew in the last complete run of pytest."""
    from fixedpipe.effects.refusal import refusals
    from fixedpipe.pipeline.golden.candidates import ORPHAN, read_run, remove_orphan
    from fixedpipe.pipeline.golden.store import read_store

    root = _place(root)
    with refusals():
        pictures = read_run(root)["pictures"]
        for store in {picture["store"] for picture in pictures.values()}:
            read_store(root / store)  # a store that cannot be read may hold an orphan
        found = {n: p for n, p in pictures.items() if p["status"] == ORPHAN}
        for name, picture in found.items():
            if remove:
                remove_orphan(root, name, picture)
            click.echo(f"{name}{', removed' if remove else ''}")
    count = f"{len(found)} orphan{'s' if len(found) > 1 else ''}"
    click.echo(count if found else "No picture is an orphan.")
    click.get_current_context().exit(PICTURES if found and not remove else 0)


@golden.command(short_help="Look at the pictures that are not golden.")
@click.option(
    "--html", metavar="FILE", help="Write a page, one file that needs no other, instead of waiting for keys."
)
@_ROOT
def review(html, root):
    """Look at the pictures that are not golden, in the terminal or on a page (--html).

    Keys in the terminal: a accepts the picture, s leaves it for later, d shows more, q ends.
    """
    from fixedpipe.effects.refusal import refusals
    from fixedpipe.effects.reports.files import writable_file, write_whole

    root = _place(root)
    if html:
        from fixedpipe.effects.reports.golden.page import golden_page

        path = writable_file(html)
        with refusals():
            write_whole(path, golden_page(root, _results(root)).encode())
        click.echo(f"{path} shows the pictures; open it in a browser.")
        return
    from fixedpipe.effects.cli.golden_review import review_by_keys

    with refusals():
        review_by_keys(root, _results(root))


@golden.command(short_help="Write test vectors for another renderer.")
@click.argument("folder", metavar="DIR")
@click.option("--profile", default="NV2A", show_default=True, metavar="NAME", help="The machine.")
@click.option(
    "--cases",
    default=256,
    show_default=True,
    type=click.IntRange(0),
    help="How many cases of each stage or rule.",
)
@click.option(
    "--frames", default=32, show_default=True, type=click.IntRange(0), help="How many whole frames."
)
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="The first case's seed.")
@click.option("--rules", is_flag=True, help="Write vectors of the NV2A's arithmetic, rule by rule, instead.")
@click.option(
    "--form",
    default="lines",
    show_default=True,
    type=click.Choice(("lines", "singlestep")),
    help="The form of --rules: a case on each line, or the form of SingleStepTests.",
)
@click.option(
    "--code",
    type=click.Choice(("c99", "glsl")),
    help="Write the NV2A's arithmetic as functions instead. They use integers only, so you can paste them.",
)
def export(folder, profile, cases, frames, seed, rules, form, code):
    """Write test vectors for another renderer into DIR.

    They are random states with their inputs and the pixels that a machine gives. JSON files have a case on
    each line, and whole frames are raw pixels. docs/golden-images.md describes the format.

    With --rules, DIR has a file for each rule of the NV2A's arithmetic: its formula, its evidence, inputs and
    results. docs/arithmetic-for-emulators.md shows them.

    With --code, the same rules are written as C99, or as GLSL 3.30 and ES 3.10. docs/code-for-emulators.md
    says how to put them into an emulator.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.golden_export import check_options, export_code, export_rules
    from fixedpipe.effects.cli.options import machine_of
    from fixedpipe.effects.refusal import refusals
    from fixedpipe.effects.reports.files import writable_folder
    from fixedpipe.effects.reports.golden.vectors import write_vectors

    check_options(click.get_current_context(), rules, code, form)
    if code:
        click.echo(export_code(folder, code))
        return
    machine, folder = machine_of(profile), writable_folder(folder)
    announce_compiling()
    if rules:
        written = export_rules(folder, cases, seed, form)
    else:
        with refusals():
            written = write_vectors(folder, machine, cases, frames, seed)
    index = "metadata.json" if form == "singlestep" else "index.json"
    click.echo(f"{len(written)} files of {machine.name}'s vectors are in {folder}; {index} names them.")


@golden.command(short_help="Test another program's arithmetic against the NV2A's.")
@click.argument("program", nargs=-1, required=True, metavar="PROGRAM [ARGUMENT]…", type=click.UNPROCESSED)
@click.option(
    "--rule", "rules", multiple=True, metavar="ID", help="Test only this rule. May be given several times."
)
@click.option(
    "--cases",
    default=256,
    show_default=True,
    type=click.IntRange(0),
    help="How many random cases of each rule.",
)
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="The first case's seed.")
@click.option(
    "--patience",
    default=20.0,
    show_default=True,
    type=click.FloatRange(0.1, 3600.0),
    help="A program that neither reads nor answers for so many seconds counts as hanging.",
)
@click.option("--json", "json_file", metavar="FILE", help="Write the scorecard as JSON.")
@click.option("--html", "html_file", metavar="FILE", help="Write the scorecard as a page.")
def judge(program, rules, cases, seed, patience, json_file, html_file):
    """Test another program's arithmetic against the NV2A's, and print for each rule how many cases are right.

    PROGRAM reads a question on each line of its standard input, and writes the answer on a line of its
    standard output. docs/code-for-emulators.md describes both. The program is started once for each rule.

    Exit status: 0 if all answers are right; 1 if one is wrong or missing; 2 if the program cannot be started.
    """
    from fixedpipe.effects.cli.golden_judge import judge_program

    whole = judge_program(program, rules, cases, seed, patience, json_file, html_file)
    click.get_current_context().exit(0 if whole else PICTURES)
