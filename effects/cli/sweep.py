"""``fixedpipe sweep``: compute a figure, a study or a script over a grid of values, on many computers."""

import sys
from pathlib import Path

import click

from fixedpipe.effects.cli.executors import executor_option, workers_of
from fixedpipe.pipeline.messages import count

_FORMS = (".png", ".svg", ".pdf")


@click.command(short_help="Compute a figure, a study or a script over a grid of values, as a table.")
@click.argument("what", metavar="ID|FILE.py")
@click.option(
    "--vary",
    "varied",
    multiple=True,
    metavar="NAME=FROM:TO:N",
    help="A parameter's values. FROM:TO:N: N values at equal distances. FROM:TO: every whole number. A,B,C: "
    "these. bits=4:16 varies the width of every number. With several --vary, all combinations are computed.",
)
@click.option(
    "--machines",
    default="paper",
    show_default=True,
    metavar="NAME,NAME,...",
    help="The machines, and IDEAL. all: every machine that can draw it. paper: the paper's machine.",
)
@click.option(
    "--set", "settings", multiple=True, metavar="NAME=VALUE", help="A parameter's value at all points."
)
@click.option(
    "--size", type=click.IntRange(min=1), metavar="N", help="Height of a figure's panels in pixels."
)
@click.option(
    "--check", is_flag=True, help="Count the acceptance checks that fail, where a figure has its own values."
)
@click.option("--reference", is_flag=True, help="Also compare a figure with its reference.")
@click.option(
    "--out", metavar="FILE", required=True, help="The table: .csv, .parquet (pandas) or .nc (xarray)."
)
@click.option("--plot", "plot_file", metavar="FILE", help="Plot the table: .png, .svg or .pdf.")
@click.option(
    "--plot-of", "column", default="rms", show_default=True, metavar="COLUMN", help="The column to plot."
)
@click.option("--pictures", metavar="DIR", help="Write every point's picture there as PNG.")
@executor_option
@click.option("--threads", type=click.IntRange(min=1), metavar="N", help="How many threads each worker has.")
@click.option(
    "--manifest",
    metavar="FILE",
    help="The file of finished points. Default: the file of --out with .manifest added.",
)
@click.option("--again", is_flag=True, help="Ignore the manifest, and compute all points.")
@click.option(
    "--no-times",
    is_flag=True,
    help="Leave out the seconds and workers, so that equal results are equal CSV files.",
)
def sweep(
    what,
    varied,
    machines,
    settings,
    size,
    check,
    reference,
    out,
    plot_file,
    column,
    pictures,
    executor,
    threads,
    manifest,
    again,
    no_times,
):
    """Compute figure ID, study ID, the FIGURE in FILE.py or the frame of a script FILE.py at every point of a
    grid, and write a row for each.

    A figure's row has the digest of its picture (sha256). Of machine - ideal it has the root mean square
    (rms) and the largest difference (largest), in 1/255 of full intensity, and how many pixels differ
    (differing). A study has a row for each row of its table.

    The manifest keeps finished points. If the command ends early, or if you enlarge the grid, give the same
    command again: it computes only what is missing. If a machine cannot draw a point, the column "refused"
    says why. If an error ends a point, the column "failed" says why, and the exit status is 1. The same
    command tries such points again.

    A script defines profile, width, height, and commands, a function of what is varied. If it has a function
    measure(result, ideal, **values), its numbers are columns too.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.frames import check_plots
    from fixedpipe.effects.cli.progress import progress
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.reports.files import writable_file, writable_folder, write_whole
    from fixedpipe.effects.sweeps.grid import named
    from fixedpipe.effects.sweeps.plots import check_plot, plot
    from fixedpipe.effects.sweeps.sweep import TASK, TIMES, sweep_of
    from fixedpipe.effects.sweeps.tables import check_kind, columns_of, write_table
    from fixedpipe.effects.tasks.manifest import Manifest
    from fixedpipe.effects.tasks.run import run

    asked = sweep_of(
        what,
        named(varied),
        [name.strip() for name in machines.split(",")],
        size=size,
        settings=_settings(settings),
        checks=check,
        reference=reference,
        pictures=pictures is not None,
    )
    path = Path(out)
    check_kind(path)
    path = writable_file(path)
    check_plots("--plot", plot_file)
    if plot_file:
        check_plot(asked)
        if Path(plot_file).suffix.lower() not in _FORMS:
            raise Refusal(f"The name {plot_file} must end with one of {', '.join(_FORMS)}.")
        plot_path = writable_file(plot_file)
    folder = writable_folder(pictures) if pictures else None
    kept = Path(manifest) if manifest else path.with_name(f"{path.name}.manifest")
    if kept.resolve() == path.resolve():
        raise Refusal(f"--manifest and --out both name {out}; give each a file of its own.")
    writable_folder(kept.parent)
    for said in asked.left_out:
        click.echo(said, err=True)
    if executor is None:
        announce_compiling()

    failed, refused = {}, 0
    with Manifest(kept, asked.about) as known, workers_of(executor, threads) as workers:
        if again:
            known.forget()
        click.echo(_plan(asked, known, workers), err=True)
        with progress(asked.points) as step:
            count_of = workers.workers if workers else lambda: 1

            def has_files(outcome):
                return all((folder / name).is_file() for name in outcome.files)

            for task, outcome in run(asked.tasks(), workers, known, workers=count_of, has_files=has_files):
                for name, data in outcome.files.items():
                    if data:
                        write_whole(folder / name, data)
                step(task.said)
                refused += bool(outcome.refused)
                if outcome.failed:
                    failed[task.digest] = f"{task.said}: {outcome.failed}"

        def rows():
            return asked.rows(known, failed, times=not no_times)

        columns = columns_of(rows(), ("refused", "failed", *TIMES, TASK))
        write_table(path, columns, rows(), _about(asked))
        if plot_file:
            write_whole(plot_path, plot(asked, rows(), column, plot_path.suffix.lower()[1:]))
    said = f"{path}: {count(asked.points, 'point')}, {count(len(columns), 'column')}"
    click.echo(f"{said}, {refused} refused" if refused else said)
    if failed:
        click.echo(f"{count(len(failed), 'point')} failed; the same command tries again:", err=True)
        click.echo("\n".join(list(failed.values())[:_SHOWN]), err=True)
        sys.exit(1)


_SHOWN = 10  # failures that are printed; the table has all


def _settings(given):
    """The texts of --set by name. Raises Refusal."""
    from fixedpipe.effects.refusal import Refusal

    found = {}
    for text in given:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals):
            raise Refusal(f"--set is {text!r}; give NAME=VALUE, as alpha_x=0.15.")
        if name in found:
            raise Refusal(f"--set names {name} twice; give it once.")
        found[name] = value
    return found


def _plan(asked, known, workers):
    grid = " x ".join(f"{len(one.values)} {one.name}" for one in asked.axes) or "one point"
    where = "here" if workers is None else f"by {count(workers.workers(), 'worker')}"
    there = f"; the manifest has {count(len(known), 'finished point')}" if len(known) else ""
    return f"{asked.about.replace('a', 'A', 1)}: {count(asked.points, 'point')} ({grid}), {where}{there}."


def _about(asked):
    """The metadata of a table: what holds for all rows."""
    from fixedpipe.pipeline.golden.provenance import package_version

    return {
        "title": asked.about,
        "axes": ",".join(one.name for one in asked.axes),
        "fixedpipe": package_version(),
        "units": "rms, largest: 1/255 of full intensity; seconds: s",
    }
