"""``fixedpipe figures``: render figures on a machine and on the ideal, check them, and make a gallery."""

import json
import sys
from contextlib import contextmanager

import click

from effects.cli.options import profile_option, threads_option


@click.command(short_help="Render figures, check them, make a gallery.")
@click.argument("figure_ids", metavar="[ID …]", nargs=-1)
@click.option("--list", "list_only", is_flag=True, help="Name the figures and end.")
@click.option("--check", is_flag=True, help="Run the acceptance checks; exit status 1 if one fails.")
@click.option(
    "--out", metavar="DIR", default="out", show_default=True, help="Folder of the pictures and the gallery."
)
@profile_option
@click.option("--size", type=click.IntRange(min=1), metavar="N", help="Edge of a figure's panels, pixels.")
@threads_option
@click.option("--json", "json_file", metavar="FILE", help="Write all results as one JSON list as well.")
def figures(figure_ids, list_only, check, out, profile, size, threads, json_file):
    """Render figures (all, or those with the given IDs): machine, ideal, and their difference made visible.

    Writes PNG files, a JSON file beside each figure, and a gallery, index.html.
    """
    from effects.cli.compiling import announce_compiling
    from effects.cli.files import writable_file, writable_folder, write_whole
    from effects.cli.refusal import check_size, choose
    from effects.figures import FIGURES
    from pipeline.profiles import PROFILES

    if list_only:
        for figure in FIGURES.values():
            click.echo(f"{figure.id:8s} {figure.title} ({', '.join(figure.techniques)}; {figure.source})")
        return
    chosen = [choose("figure", i, FIGURES) for i in dict.fromkeys(figure_ids)] or list(FIGURES.values())
    machine = choose("profile", profile, PROFILES)
    folder = writable_folder(out)
    json_path = writable_file(json_file) if json_file else None
    for figure in chosen:
        check_size(figure.id, figure.columns, size or figure.size, machine)

    announce_compiling()
    from effects.cli.gallery import gallery
    from effects.cli.rendering import render

    records = []
    with _progress(len(chosen) * (4 if check else 3)) as step:
        for figure in chosen:
            rendered = render(figure, profile, machine, size, threads, check, step)
            for name, data in rendered.files.items():
                write_whole(folder / name, data)
            records.append(rendered.record)
    write_whole(folder / "index.html", gallery(folder, FIGURES).encode())
    if json_path:
        write_whole(json_path, (json.dumps(records, indent=2) + "\n").encode())
    failed = _print_checks(records) if check else 0
    click.echo(f"{len(records)} figure{'s' * (len(records) != 1)} in {folder}; open {folder / 'index.html'}")
    if failed:
        click.echo(f"{failed} acceptance check{'s' * (failed != 1)} failed.", err=True)
        sys.exit(1)


@contextmanager
def _progress(steps):
    """A function that says what is being done: a progress bar on a terminal, else a line per step."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    console = Console(stderr=True, highlight=False)
    if not console.is_terminal:
        yield lambda text: click.echo(text, err=True)
        return
    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("", total=steps)
        begun = False

        def step(text):
            nonlocal begun
            progress.update(task, description=text, advance=1 if begun else 0)
            begun = True

        yield step


def _print_checks(records):
    """Print every check with its value and bound; returns how many failed."""
    failed = 0
    for record in records:
        for c in record["checks"]:
            failed += not c["passed"]
            verdict = "ok    " if c["passed"] else "FAILED"
            measured = f"{c['value']:.4g} {c['relation']} {c['bound']:.4g}"
            click.echo(
                f"{record['id']:8s} {verdict} {c['name']}, on the {c['on']}: {measured} ({c['reason']})"
            )
    return failed
