"""``fixedpipe animate``: an animation of a figure, in which its light, its camera or its bits change."""

from pathlib import Path

import click

from fixedpipe.effects.cli.executors import executor_option, kept_work, manifest_option
from fixedpipe.effects.cli.options import (
    changes_of,
    machine_of,
    refuse_beside,
    refuse_ignored,
    set_option,
    threads_option,
)


@click.command(short_help="Draw an animation of a figure: APNG, WebP or MP4.")
@click.argument("figure_id", metavar="[ID|FILE.py]", required=False)
@click.option("--list", "list_only", is_flag=True, help="Print the declared animations, and draw nothing.")
@click.option(
    "--vary",
    "moves",
    metavar="NAME=FROM:TO[:STEPS]",
    multiple=True,
    help="Change a parameter from one value to another, such as alpha_x=0.1:1 or light=1,0,1:-1,0,2:48. A "
    "value with commas may pass through more than two values. Several parameters change together.",
)
@click.option(
    "--precision", "bits", metavar="FROM:TO", help="Change the bits of every number, 4 to 16, such as 4:16."
)
@click.option("--frames", "count", type=int, metavar="N", help="How many frames, if --vary has no STEPS.")
@click.option(
    "--out",
    metavar="FILE",
    help="A .png (APNG), .webp or .mp4 file. Default: an APNG named after figure and machine.",
)
@click.option(
    "--fps",
    type=int,
    metavar="N",
    help="Frames per second, 1 to 60. Default: 15, or 2 with --precision alone.",
)
@click.option(
    "--loop/--no-loop", default=True, show_default=True, help="Whether players repeat the animation."
)
@click.option("--profile", metavar="NAME", help="The machine, or IDEAL. Default: the figure's own.")
@click.option(
    "--size", type=click.IntRange(min=1), metavar="N", help="Height of the figure's panels in pixels."
)
@set_option
@threads_option
@executor_option
@manifest_option
def animate(
    figure_id,
    list_only,
    moves,
    bits,
    count,
    out,
    fps,
    loop,
    profile,
    size,
    settings,
    threads,
    executor,
    manifest,
):
    """Draw an animation of figure ID, or of the FIGURE in your FILE.py. --vary changes a parameter, and
    --precision the width of the machine's numbers. Without both, the figure's declared animation is drawn.

    Numbers change evenly, directions along the arc between them, and whole numbers in steps. Every frame of
    an APNG or WebP file has the machine's pixels. MP4 is lossy, and needs pip install 'fixedpipe[video]'.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.progress import progress
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.figures import FIGURES
    from fixedpipe.effects.presentation.animations import ANIMATIONS, Animation
    from fixedpipe.effects.presentation.movies import check_edges, check_rate, kind_of, write_animation
    from fixedpipe.effects.presentation.variation import frames_of, pictures_of
    from fixedpipe.effects.refusal import Refusal, choose, refusals
    from fixedpipe.effects.reports.figure_record import variant_name
    from fixedpipe.effects.reports.files import writable_file, written_whole
    from fixedpipe.effects.reports.own_figures import figure_of
    from fixedpipe.effects.tasks.arrays import unpacked
    from fixedpipe.effects.tasks.ordered import in_order
    from fixedpipe.pipeline.profiles import PROFILES

    context = click.get_current_context()
    if list_only:
        refuse_beside(context, "--list")
        for identifier, declared in ANIMATIONS.items():
            click.echo(f"{identifier:8s} {declared.does} ({FIGURES[identifier].title})")
        return
    if figure_id is None:
        raise Refusal("Name a figure; fixedpipe animate --list has those that move by themselves.")
    if executor or manifest:
        said = "workers read files as they are; leave --executor and --manifest out"
        refuse_ignored(context, ("limit", "fill"), said)
    figure = figure_of(figure_id)
    key = profile or figure.machines[0]
    with refusals():
        method = figure.method(key)
        if moves or bits:
            tracks, steps = _tracks(moves, figure, method)
            if count is not None and steps is not None:
                refuse_ignored(context, ("count",), "the STEPS of --vary say how many frames; leave one out")
            found = Animation("", tracks, _bits(bits), steps or count, 15 if moves else 2)
        elif figure.id in ANIMATIONS:
            found = ANIMATIONS[figure.id]
        else:
            raise Refusal(
                f"{figure.id} has no animation of its own; say what moves, as in --vary "
                f"light=1,0,1:-1,0,1 or --precision 4:16. These have one: {', '.join(ANIMATIONS)}."
            )
        machine = machine_of(key) if found.bits else choose("profile", key, PROFILES)
        changes = changes_of(settings, figure, (method,))
        for name in changes.keys() & found.tracks.keys():
            raise Refusal(f"{name} moves, so --set {name} would be ignored; leave one of them out.")
        frames = frames_of(figure, method, found.tracks, found.bits, count or found.count)
    check_size(figure.id, figure.dimensions(size), machine)
    name = Path(out or f"{variant_name(figure, changes)}-{key}-animation.png")
    rate = found.frames_a_second if fps is None else fps
    check_rate(rate)
    _, kind = kind_of(name)
    width, height = figure.dimensions(size)
    check_edges(name, width, height)
    path = writable_file(name)
    announce_compiling(None if executor else "vector")
    about = f"an animation of {figure.id}"
    with (
        kept_work(executor, manifest, about, threads) as (workers, known),
        progress(len(frames)) as step,
        refusals(),
        written_whole(path) as temporary,
    ):

        def drawn():
            if workers or known is not None:
                tasks = _tasks(figure_id, figure, key, frames, size, settings)
                done = in_order(tasks, workers, known)
                pictures = (unpacked(outcome.files[_PICTURE]) for outcome in done)
            else:
                pictures = pictures_of(
                    figure, machine, frames, size, method=method, threads=threads, changes=changes
                )
            for frame in frames:
                step(f"{figure.id}: {frame.said}")
                yield next(pictures)

        write_animation(temporary, drawn(), len(frames), rate, loop)
    click.echo(
        f"{path}: {len(frames)} frames of {width}x{height} pixels, {rate} a second, {kind}, "
        f"{path.stat().st_size / 1e6:.2g} MB"
    )


_PICTURE = "picture"


def _tasks(figure_id, figure, key, frames, size, settings):
    """A Task for each frame. The arguments are those of ``picture_there``, and the Figure."""
    from fixedpipe.effects.tasks.environment import file_digests, whole_inputs
    from fixedpipe.effects.tasks.task import Task

    values = (setting.partition("=")[2].strip() for setting in settings)
    inputs = whole_inputs(*file_digests((figure_id, *values)))
    for frame in frames:
        parameters = {
            "figure_id": figure_id,
            "key": key,
            "changes": dict(frame.changes),
            "bits": frame.bits,
            "size": size,
            "settings": settings,
        }
        yield Task(picture_there, parameters, f"{figure.id} {frame.said} on {key}", inputs)


def picture_there(figure_id, key, changes, bits, size, settings):
    """Draw a frame in a worker. Returns no value, and the picture, uint8 [h, w, 3], as a packed file.

    changes, bits  those of a ``variation.Frame``
    settings       the texts of --set
    """
    from fixedpipe.effects.presentation.variation import Frame, picture_of
    from fixedpipe.effects.reports.own_figures import figure_of
    from fixedpipe.effects.tasks.arrays import packed
    from fixedpipe.pipeline.profiles import PROFILES

    figure = figure_of(figure_id)
    method = figure.method(key)
    frame, others = Frame(changes, bits, ""), changes_of(settings, figure, (method,))
    return None, {_PICTURE: packed(picture_of(figure, PROFILES[key], frame, size, method, None, others))}


def _tracks(moves, figure, method):
    """(Tracks by name, their number of STEPS or None), from --vary. Raises Refusal."""
    from fixedpipe.effects.presentation.variation import Track, moving
    from fixedpipe.effects.refusal import Refusal

    tracks, said = {}, set()
    for move in moves:
        name, equals, text = (part.strip() for part in move.partition("="))
        texts = [part.strip() for part in text.split(":")]
        if not (name and equals) or len(texts) < 2:
            raise Refusal(
                f"--vary is {move!r}; give NAME=FROM:TO or NAME=FROM:TO:STEPS, as alpha_x=0.1:1:24."
            )
        if name in tracks:
            raise Refusal(f"--vary names {name} twice; give it once.")
        parameter = moving(figure, name, method)
        if len(texts) > 2 and "," not in texts[-1]:
            steps = texts.pop()
            if not steps.isdigit() or not int(steps):
                raise Refusal(f"--vary {name} has {steps!r} steps; give a whole number from 1.")
            said.add(int(steps))
        if len(texts) > 2 and "," not in texts[0]:
            raise Refusal(f"--vary {name} is {text!r}; give FROM:TO or FROM:TO:STEPS.")
        tracks[name] = Track(tuple(parameter.parse(part, f"{figure.id}'s {name}") for part in texts))
    if len(said) > 1:
        raise Refusal(
            f"--vary says {' and '.join(map(str, sorted(said)))} steps; they go together: give one."
        )
    return tracks, next(iter(said), None)


def _bits(text):
    """The first and the last width of --precision, or None. Raises Refusal."""
    from fixedpipe.effects.refusal import Refusal

    if text is None:
        return None
    parts = text.split(":")
    if len(parts) != 2 or not all(part.strip().isdigit() for part in parts):
        raise Refusal(f"--precision is {text!r}; give two widths in bits, as 4:16.")
    return int(parts[0]), int(parts[1])
