"""``fixedpipe study``: measure an artefact of the hardware, and print a table, what it says, and a plot."""

import sys
from importlib import metadata

import click

from fixedpipe.effects.cli.executors import executor_option, kept_work, manifest_option
from fixedpipe.effects.cli.options import machine_of, refuse_ignored
from fixedpipe.effects.reports.study_record import json_bytes, measured, plotted


@click.command(short_help="Measure an artefact of the hardware: a table and a plot.")
@click.argument("study_ids", metavar="[ID …|all]", nargs=-1)
@click.option(
    "--profile", metavar="NAME", help="One of the machines that the study names. Default: the study's own."
)
@click.option(
    "--check", is_flag=True, help="Compare with the expected numbers. Exit status 1 if one is missed."
)
@click.option(
    "--out", metavar="DIR", default="out", show_default=True, help="Folder of plots and JSON files."
)
@click.option("--json", "json_file", metavar="FILE", help="Also write all results as one JSON list.")
@click.option("--csv", "csv_file", metavar="FILE", help="Also write the table of a study as CSV.")
@executor_option
@manifest_option
def study(study_ids, profile, check, out, json_file, csv_file, executor, manifest):
    """Measure the studies with the given IDs, or all, on the emulated machines. Without an ID, the command
    prints the names of all studies. --check without an ID measures all.

    It prints each table and what the numbers say, and writes ID.json and a plot, ID.png. Plots need
    matplotlib: pip install 'fixedpipe[plots]'.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.refusal import Refusal, choose
    from fixedpipe.effects.reports.files import writable_file, writable_folder, write_whole
    from fixedpipe.effects.reports.rows import csv_text
    from fixedpipe.effects.studies import STUDIES
    from fixedpipe.effects.tasks.ordered import in_order
    from fixedpipe.effects.technique import INDEX

    if not study_ids and not check:
        refuse_ignored(
            click.get_current_context(),
            ("profile", "out", "json_file", "csv_file", "executor", "manifest"),
            "without an ID studies are named, not measured; give IDs, or all",
        )
        for s in STUDIES.values():
            click.echo(f"{s.id:4s} {s.title} ({', '.join(s.techniques)}; {s.source})")
        click.echo(f"{INDEX} says what the ids in brackets are.", err=True)
        return
    chosen = [choose("study", i, STUDIES) for i in dict.fromkeys(study_ids) if i != "all"]
    if "all" in study_ids or not study_ids:
        chosen = list(STUDIES.values())
    if csv_file and len(chosen) > 1:
        raise Refusal(f"A CSV file has one table, and these are {len(chosen)}; give one ID, or --json.")
    machines = [_machine(s, profile, check) for s in chosen]
    folder = writable_folder(out)
    json_path, csv_path = (name and writable_file(name) for name in (json_file, csv_file))
    if executor is None:
        announce_compiling()

    records, missed, without_plot = [], 0, False
    tasks = [_task(s, key, check) for s, key in zip(chosen, machines, strict=True)]
    with kept_work(executor, manifest, "studies") as (workers, known):
        if workers or known is not None:
            found = ((done.value, done.files) for done in in_order(tasks, workers, known))
        else:
            found = (measured_there(**task.parameters) for task in tasks)
        for number, (s, (value, files)) in enumerate(zip(chosen, found, strict=True)):
            record, picture = value["record"], files.get(_PLOT)
            click.echo("\n" * bool(number) + value["printed"])
            missed += _print_checks(record["checks"])
            without_plot |= picture is None
            if picture is not None:
                record["plot"] = f"{s.id}.png"
                write_whole(folder / record["plot"], picture)
            write_whole(folder / f"{s.id}.json", json_bytes(record))
            records.append(record)
    if json_path:
        write_whole(json_path, json_bytes(records))
    if csv_path:
        write_whole(csv_path, csv_text(records[0]["rows"]).encode())
    if without_plot:
        click.echo(
            f"The tables are in {folder}, without plots: these need matplotlib, which is not installed. "
            "pip install 'fixedpipe[plots]' brings it.",
            err=True,
        )
    click.echo(f"\n{len(records)} stud{'ies' if len(records) > 1 else 'y'} in {folder}")
    if missed:
        click.echo(f"{missed} expected number{'s' * (missed != 1)} missed.", err=True)
        sys.exit(1)


_PLOT = "plot.png"


def _task(s, key, check):
    from importlib.util import find_spec

    from fixedpipe.effects.reports.figure_inputs import inputs_of
    from fixedpipe.effects.studies import STUDIES
    from fixedpipe.effects.tasks.task import Task

    parameters = {"study_id": s.id, "key": key, "check": check}
    plots = metadata.version("matplotlib") if find_spec("matplotlib") else None
    inputs = inputs_of(STUDIES.module_of(s.id), ("study", plots))
    return Task(measured_there, parameters, f"{s.id} on {key}" if key else s.id, inputs)


def measured_there(study_id, key, check):
    """Measure a study in a worker. Returns the text for the terminal and the study's record, and its plot as
    a file if matplotlib is installed.
    """
    from fixedpipe.effects.studies import STUDIES

    s = STUDIES[study_id]
    table, record = measured(s, key, check)
    picture = plotted(s, table)
    return {"printed": _printed(s, key, table), "record": record}, {_PLOT: picture} if picture else {}


def _machine(s, profile, check):
    """The key of the machine to measure a study on; None if the study has no machines. Raises Refusal."""
    from fixedpipe.effects.refusal import Refusal

    own = s.machines[0] if s.machines else None
    if profile is None:
        return own
    machine_of(profile)
    if profile not in s.machines:
        instead = f"one of {', '.join(s.machines)}" if s.machines else "no --profile"
        raise Refusal(f"{s.id} cannot be measured on {profile}; give {instead}.")
    if check and profile != own:
        raise Refusal(f"The expected numbers of {s.id} are for {own}; give that --profile, or no --check.")
    return profile


def _printed(s, key, table):
    """The text that the terminal shows of a study, at most ``WIDTH`` columns wide."""
    from textwrap import fill

    from fixedpipe.effects.studies.study import WIDTH
    from fixedpipe.pipeline.profiles import PROFILES

    on = f", on {PROFILES[key].name}" if key else ""
    parts = (
        fill(f"{s.id}: {s.title}{on}", WIDTH),
        fill(s.question, WIDTH),
        table.text(),
        *(fill(sentence, WIDTH) for sentence in s.findings(table)),
    )
    return "\n\n".join(parts)


def _print_checks(checks):
    """Print every check with its value and bound. Returns how many failed."""
    for c in checks:
        verdict = "ok    " if c["passed"] else "FAILED"
        click.echo(
            f"{verdict} {c['name']}: {c['value']:.4g} {c['relation']} {c['bound']:.4g} ({c['reason']})"
        )
    return sum(not c["passed"] for c in checks)
