"""``fixedpipe figures``: draw figures on a machine and on the ideal, check them, and make a gallery."""

import itertools
import json
import sys
from contextlib import contextmanager

import click

from fixedpipe.effects.cli.executors import executor_option, workers_of
from fixedpipe.effects.cli.options import refuse_beside, set_option, threads_option
from fixedpipe.effects.cli.progress import error_console
from fixedpipe.pipeline.messages import count

# The value of --profile for the machine that a figure's paper used.
PAPER = "paper"


@click.command(short_help="Draw figures, check them, and make a gallery.")
@click.argument("figure_ids", metavar="[ID|FILE.py …]", nargs=-1)
@click.option("--list", "list_only", is_flag=True, help="Print the figures' names, and draw nothing.")
@click.option("--check", is_flag=True, help="Run the acceptance checks; exit status 1 if one fails.")
@click.option("--out", metavar="DIR", default="out", show_default=True, help="Folder of the gallery.")
@click.option(
    "--png", metavar="DIR", help="Also write each picture there as a PNG file, such as F004-4-OCTANE.png."
)
@click.option(
    "--supersample",
    type=click.IntRange(2, 8),
    metavar="N",
    help="With --png: draw N times as large; a pixel of the PNG file is the mean of N x N pixels.",
)
@click.option(
    "--gutter", type=click.IntRange(1, 200), metavar="N", help="With --png: white pixels between panels."
)
@click.option(
    "--inset",
    metavar="X,Y,W,H,ZOOM",
    help="With --png: enlarge this rectangle (pixels) ZOOM times, in a corner of its panel.",
)
@click.option(
    "--profile",
    "profiles",
    metavar="NAME",
    multiple=True,
    help="A machine, IDEAL, or paper for the machine of the figure's paper. May be given several times. "
    "Default: every machine that can draw the figure.",
)
@click.option(
    "--size", type=click.IntRange(min=1), metavar="N", help="Height of a figure's panels in pixels."
)
@click.option("--again", is_flag=True, help="Also draw figures that did not change.")
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    metavar="N",
    help="How many processes draw. Default: one for each processor.",
)
@executor_option
@set_option
@threads_option
@click.option("--json", "json_file", metavar="FILE", help="Also write all results as one JSON list.")
def figures(
    figure_ids,
    list_only,
    check,
    out,
    png,
    supersample,
    gutter,
    inset,
    profiles,
    size,
    again,
    jobs,
    executor,
    settings,
    threads,
    json_file,
):
    """Draw figures: all, or those with the given IDs. Each has the machine's picture, the ideal's, and their
    difference, enlarged so that you see it.

    FILE.py is a file of your own that holds a FIGURE, with its checks. It is always drawn again.

    The command writes a gallery, index.html, with pictures and a JSON file for each figure. A figure whose
    sources, machines, size and packages did not change is not drawn again. A figure that is drawn again
    replaces its pictures of all machines. Several processes draw several figures.

    Without an ID, a first round draws each figure on its first machine, without reference and checks. A
    second round draws the rest. With --profile, only figures are drawn that one of these machines can draw.

    With --set a figure is a variant. Its files have names of their own, and say what was changed. PNG files
    have 16 bits a component if the machine has more than 8. Equal pictures have no file of their difference.

    If a figure fails, the others are drawn all the same. Its card in the gallery and the command's last lines
    say what failed, and the exit status is 1. If the disc is full, no further figure is begun, and finished
    figures stay.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.options import changes_of
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.figures import FIGURES
    from fixedpipe.effects.figures.costs import cheapest_first, longest_after_the_first
    from fixedpipe.effects.refusal import Refusal, choose, refusals
    from fixedpipe.effects.reports.figure_times import OwnTimes, read_times
    from fixedpipe.effects.reports.files import writable_file, writable_folder, write_whole
    from fixedpipe.effects.technique import INDEX
    from fixedpipe.pipeline.profiles import PROFILES

    if list_only:
        refuse_beside(click.get_current_context(), "--list")
        for figure in FIGURES.values():
            click.echo(f"{figure.id:8s} {figure.title} ({', '.join(figure.techniques)}; {figure.source})")
            click.echo(f"{'':8s} on {', '.join(figure.machines)}")
        click.echo(f"{INDEX} says what the ids in brackets are.", err=True)
        return
    chosen, files_of_users = _chosen(figure_ids)
    for name in profiles:
        if name != PAPER and choose("profile", name, PROFILES).arithmetic.exact and check:
            raise Refusal(f"--check compares machines with {name}; leave it out, or give a machine.")
    with refusals():
        machines = {f.id: _machines(f, profiles, bool(figure_ids)) for f in chosen}
    chosen = [figure for figure in chosen if machines[figure.id]]
    if not chosen:
        named = " or ".join(profiles)
        raise Refusal(f"No figure can be drawn on {named}; fixedpipe figures --list has their machines.")
    if settings and not figure_ids:
        raise Refusal("--set changes a figure; name it, as in fixedpipe figures F004-4 --set alpha_x=0.15.")
    if executor and (settings or jobs):
        raise Refusal(
            "--executor draws figures with their own values, by as many workers as it has; leave --set and "
            "--jobs out. fixedpipe sweep varies values."
        )
    if settings and check:
        raise Refusal("--check holds for a figure's own values; leave out --check, or --set.")
    changes = {f.id: changes_of(settings, f, {f.method(m): m for m in machines[f.id]}) for f in chosen}
    folder, named = writable_folder(out), _plates(png, supersample, gutter, inset)
    json_path = writable_file(json_file) if json_file else None
    sizes = {figure.id: size for figure in chosen}
    for figure in chosen if named else ():
        width, height = figure.dimensions(size)
        if named.inset:
            named.inset.check(figure.id, width, height, figure.columns)
        if supersample:
            sizes[figure.id] = supersample * height
    for figure in chosen:
        for machine in machines[figure.id]:
            check_size(figure.id, figure.dimensions(sizes[figure.id]), PROFILES[machine])

    for figure in chosen:
        for name in changes[figure.id]:
            known = figure.parameter(name, figure.method(machines[figure.id][0]))
            own = f"{figure.id} itself has {name}={known.kind.show(known.default)}."
            said = own if known.default is not None else f"{name}:"
            click.echo(f"{said} {known.does}", err=True)
    from fixedpipe.effects.reports.figure_failures import failures_of, in_words
    from fixedpipe.effects.reports.figure_files import files_of, own_ids, set_aside, tidy, unchanged
    from fixedpipe.effects.reports.figure_inputs import inputs_of
    from fixedpipe.effects.reports.figure_pool import Order, draw_all, draw_here
    from fixedpipe.effects.reports.figure_record import steps
    from fixedpipe.effects.reports.figure_tasks import draw_by
    from fixedpipe.pipeline.native.threads import default_threads
    from fixedpipe.raster.kernel_folder import results_folder

    results = results_folder()
    if former := set_aside(folder, FIGURES):
        click.echo(f"{count(former, 'record')} of an earlier version now end in .former.", err=True)
    ids = tuple(dict.fromkeys((*FIGURES, *files_of_users, *own_ids(folder))))  # the gallery's figures
    before = itertools.chain.from_iterable(files_of(folder, ids))
    before, records, orders, firsts = list(before), {}, {}, {}
    for figure in chosen:
        # A value of --set, or the figure, may be a user's file. No digest here covers its content.
        made_from, file = None, files_of_users.get(figure.id)
        if not (settings or file):
            what = figure.id, machines[figure.id], sizes[figure.id], check
            made_from = inputs_of(FIGURES.module_of(figure.id), what)
        if not (again or settings or named or file):
            records[figure.id] = unchanged(folder, figure.id, made_from)
        if not records.get(figure.id):
            order = (
                figure.id,
                machines[figure.id],
                sizes[figure.id],
                threads,
                check,
                folder,
                named,
                made_from,
                file,
            )
            orders[figure.id] = Order(*order, results=results)
    if kept := len(chosen) - len(orders):
        click.echo(f"{count(kept, 'figure')} did not change and stay; --again draws all.", err=True)
    # If all figures are drawn, the first round draws a picture of each before the rest is drawn.
    for order in () if figure_ids or executor else orders.values():
        first = order.first()
        if first and (again or not unchanged(folder, first.id, first.inputs)):
            firsts[first.id] = first
    left = [figure for figure in chosen if figure.id in orders]
    early = [figure for figure in left if figure.id in firsts]
    processors = default_threads()
    jobs = 1 if settings else min(len(left), jobs or processors)
    own_sizes = size is None and not settings
    if left:
        # Several processes share the compiling, and a check draws with both engines.
        if not executor:
            announce_compiling("vector" if jobs == 1 and not check else None)
        known = read_times(results if own_sizes else None)
        click.echo(_plan(left, early, machines, check, own_sizes, jobs, executor, known), err=True)
    in_order = longest_after_the_first if jobs > 1 else cheapest_first
    inside = [of[figure.id] for of, some in ((firsts, early), (orders, left)) for figure in in_order(some)]
    number = sum(steps(figure, machines[figure.id], check) for figure in left)
    number += sum(steps(figure, firsts[figure.id].machines, with_references=False) for figure in early)
    awaited, times = set(firsts), OwnTimes()
    number = len(inside) if executor else number
    with workers_of(executor if inside else None, threads) as workers, _progress(number) as shown:
        step, compiling, say = shown
        if workers:
            drawn = draw_by(workers, inside, step)
        elif jobs > 1:
            drawn = draw_all(inside, jobs, max(1, processors // jobs), step, compiling)
        else:
            drawn = draw_here(inside, step, changes)
        for order, record, taken in drawn:
            records[order.id] = record
            _write_page(folder, ids)
            if not order.is_first:
                del orders[order.id]
                if check and order.machines == order.figure.machines and not failures_of(record):
                    times.whole[order.id] = taken
                    if len(left) >= _MANY and len(orders) in _quarters(len(left)):
                        say(_on_the_way(left, orders, machines, own_sizes and times, jobs))
            elif order.id in awaited:
                awaited.remove(order.id)
                times.first[order.id] = taken
                if not awaited:
                    own = own_sizes and OwnTimes(times.first, known.whole)
                    say(_after_the_first_round(folder, left, early, machines, own, jobs))
    if own_sizes and results and not (figure_ids or executor):
        times.write(results)
    failed_early = {i for i in orders if records.get(i) and failures_of(records[i])}
    missing = [figure.id for figure in chosen if figure.id in orders.keys() - failed_early]
    records = [records[figure.id] for figure in chosen if records.get(figure.id)]
    failures = [f"{record['id']}: {sentence}" for record in records for sentence in in_words(record)]
    failures += [f"{i}: not begun, because the disc is full" for i in missing]
    failures += _write_page(folder, ids)
    # If all figures are drawn, hundreds of checks pass; the gallery shows them.
    passed, failed = _print_checks(records, only_failed=not figure_ids)
    if check:
        click.echo(f"{count(passed, 'acceptance check')} passed.")
    number, size = tidy(folder, ids, before)
    kept = f"{count(number, 'figure')} in {folder}, {size / 1e6:.1f} MB"
    click.echo(f"{kept}; open {folder / 'index.html'}")
    if failed:
        click.echo(f"{count(failed, 'acceptance check')} failed.", err=True)
    if failures:
        whole = sum(not failures_of(record) for record in records)
        click.echo(f"{whole} of {count(len(chosen), 'figure')} are whole. What failed:", err=True)
        click.echo("\n".join(failures), err=True)
    if json_path:
        write_whole(json_path, (json.dumps(records, indent=2) + "\n").encode())
    if failed or failures:
        sys.exit(1)


def _plates(png, supersample, gutter, inset):
    """The Plates of --png, None without it. Raises Refusal for options that need --png, without --png."""
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.reports.files import writable_folder
    from fixedpipe.effects.reports.plates import Inset, Plates

    if not png:
        asked = [("--supersample", supersample), ("--gutter", gutter), ("--inset", inset)]
        for name, value in asked:
            if value is not None:
                raise Refusal(f"{name} finishes the PNG files of --png; give --png DIR as well.")
        return None
    found = Inset.parse(inset) if inset is not None else None
    if supersample:
        said = f"{supersample} times as large and averaged over squares of {supersample}x{supersample}"
        click.echo(f"The PNG files are drawn {said}: say so in their caption.", err=True)
    return Plates(writable_folder(png), supersample or 1, gutter or 0, found)


def _chosen(words):
    """(figures, files): the figures that ``words`` name by id or by file, and the files of users' figures, by
    id. Without words, all figures of the package.
    """
    from fixedpipe.effects.figures import FIGURES
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.reports.own_figures import KIND, figure_of

    chosen, files = {}, {}
    for word in words or FIGURES:
        figure = figure_of(word)
        if word.endswith(KIND) and files.setdefault(figure.id, word) != word:
            raise Refusal(f"{files[figure.id]} and {word} both hold {figure.id}. Give one another id.")
        chosen[figure.id] = figure
    return list(chosen.values()), files


def _write_page(folder, figures):
    """Write the gallery's page of ``figures``, ids in the page's order. Returns a list: empty, or one
    sentence that says why the page could not be written.
    """
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.reports.figure_files import write_page

    try:
        write_page(folder, figures)
    except Refusal as refusal:
        return [str(refusal)]
    return []


def _plan(chosen, early, machines, check, own_sizes, jobs, executor, known):
    """A sentence before the work: how many figures, on how many machines, and how long it takes. ``known``:
    OwnTimes.
    """
    from fixedpipe.effects.figures.costs import PROCESSOR, SECONDS

    drawings = sum(len(names) for names in machines.values())
    different = len({name for names in machines.values() for name in names})
    what = f"{count(len(chosen), 'figure')} on {count(different, 'machine')}, {count(drawings, 'drawing')}"
    if check:
        what += " with acceptance checks"
    if executor:
        return f"{what}, by {executor}, the longest early."
    if jobs > 1:
        what += f", in {jobs} processes, the cheapest and then the longest first"
    else:
        what += ", the cheapest first" * (len(chosen) > 1)
    if not own_sizes or not SECONDS.keys() >= machines.keys():
        return f"{what}."
    where = f"on {PROCESSOR.replace('one core', f'{jobs} cores') if jobs > 1 else PROCESSOR}"
    if known.knows(chosen):
        where = "here, as before"
    whole = known.of_whole(chosen, machines) / jobs
    if not early:
        return f"{what}: {'about' if check else 'less than'} {_time(whole)} {where}."
    first = known.of_first(early) / jobs
    return (
        f"{what}. The first picture of every figure takes about {_time(first)} {where}, and the rest "
        f"{'about' if check else 'less than'} {_time(whole)} more."
    )


def _after_the_first_round(folder, chosen, early, machines, times, jobs):
    """A text after the first round: which pictures exist now, and how long the rest takes.

    ``times``: OwnTimes of this run's first round and of earlier runs' second round; false: not usable here.
    """
    from fixedpipe.effects.figures.costs import SECONDS, seconds_of

    said = f"{folder / 'index.html'} has a picture of every figure. What else was asked for goes on"
    if times and SECONDS.keys() >= machines.keys():
        speed = sum(times.first[figure.id] for figure in early) / seconds_of(early)
        said += (
            f", about {_time(times.of_whole(chosen, machines, speed) / jobs)} at the speed of these pictures"
        )
    return f"{said}; Ctrl-C keeps what is there."


# A run of at least so many figures prints a few times how long it still takes.
_MANY = 12


def _quarters(number):
    """How many of ``number`` are left when a quarter, a half and three quarters are done."""
    return {number - number * k // 4 for k in (1, 2, 3)}


def _on_the_way(chosen, orders, machines, times, jobs):
    """A sentence: how many figures are finished, and how long the others take at the speed of these."""
    from fixedpipe.effects.figures.costs import SECONDS

    left = [figure for figure in chosen if figure.id in orders]
    said = f"{len(chosen) - len(left)} of {count(len(chosen), 'figure')} are whole"
    done = [figure for figure in chosen if times and figure.id in times.whole]
    if done and SECONDS.keys() >= machines.keys():
        speed = sum(times.whole[f.id] for f in done) / sum(SECONDS[f.id] for f in done)
        said += (
            f"; the others take about {_time(times.of_whole(left, machines, speed) / jobs)} at their speed"
        )
    return f"{said}."


def _time(seconds):
    return count(round(seconds / 60), "minute") if seconds >= 90 else count(int(seconds) + 1, "second")


def _machines(figure, profiles, is_named):
    """The machines of ``profiles`` that can draw the figure; if ``profiles`` is empty, all that can. If a
    user named the figure and none of them can draw it, a ValueError names the machines that can.
    """
    from fixedpipe.pipeline.profiles import PROFILES

    wanted = dict.fromkeys(figure.machines[0] if name == PAPER else name for name in profiles)
    able = tuple(m for m in wanted if m in figure.machines or PROFILES[m].arithmetic.exact)
    if wanted and is_named and not able:
        figure.method(next(iter(wanted)))
    return able if profiles else figure.machines


@contextmanager
def _progress(steps):
    """Yields three functions. The first shows each step that begins, the second each kernel that another
    process compiles: on a progress bar on a terminal, otherwise as lines. The third prints a sentence.
    """
    from fixedpipe.effects.cli.compiling import said_now_and_then

    console = error_console()
    if not console.is_terminal:

        def say(text):
            click.echo(text, err=True)

        yield say, said_now_and_then(), say
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("", total=steps)
        begun = False

        def step(text):
            nonlocal begun
            progress.update(task, description=text, advance=1 if begun else 0)
            begun = True

        yield (
            step,
            lambda kernel: progress.update(task, description=f"compiling {kernel}"),
            lambda text: progress.console.print(text, markup=False, highlight=False, soft_wrap=True),
        )


def _print_checks(records, only_failed):
    """Print every check, or only failed ones, with value and bound. Returns how many passed and failed."""
    passed = failed = 0
    for record in records:
        for drawn in record["machines"]:
            for c in drawn["checks"]:
                passed, failed = passed + c["passed"], failed + (not c["passed"])
                if c["passed"] and only_failed:
                    continue
                verdict = "ok    " if c["passed"] else "FAILED"
                measured = f"{c['value']:.4g} {c['relation']} {c['bound']:.4g}"
                where = drawn["profile"] if c["on"] == "machine" else f"ideal ({drawn['method']})"
                click.echo(f"{record['id']:8s} {verdict} {c['name']}, {where}: {measured} ({c['reason']})")
    return passed, failed
