"""``fixedpipe replay``: draw the frames of a recorded OpenGL program on a machine of its time."""

import json
import sys
from contextlib import contextmanager
from itertools import chain
from pathlib import Path

import click

from fixedpipe.effects.cli.options import machine_of, refuse_ignored, threads_option
from fixedpipe.effects.cli.progress import error_console

_USUAL = "GEFORCE_256"


@click.command(short_help="Draw the frames of a recorded OpenGL program (a trace of apitrace).")
@click.argument("trace", metavar="FILE.trace|-")
@click.option(
    "--profile", metavar="NAME", help=f"The machine. Default: {_USUAL}. With --list: judge only this machine."
)
@click.option(
    "--frames",
    metavar="LIST",
    help="Numbers of frames from 0, such as 3,10-20, or all. Default: the first frame that draws.",
)
@click.option("--out", metavar="DIR", default="out", show_default=True, help="Folder of the pictures.")
@click.option("--size", metavar="WxH", help="Pixels of every window. Default: what the trace says.")
@click.option(
    "--list",
    "list_only",
    is_flag=True,
    help="Draw nothing. Print what the trace uses, what each machine would refuse, and which one to take.",
)
@click.option(
    "--check",
    "checked",
    is_flag=True,
    help="Compare the answers of glGet and similar calls with those in the trace, to its end.",
)
@click.option(
    "--beside",
    type=click.Choice(["mesa"]),
    help="Compare with Mesa's pictures of these frames, which glretrace draws. Needs apitrace and Xvfb.",
)
@click.option(
    "--page",
    metavar="FILE.html",
    help="Write a page instead: the frames on several machines, by the ideal and by Mesa, and the calls.",
)
@click.option(
    "--json",
    "json_file",
    metavar="FILE",
    help="Write the frames and the summary as JSON, or what --list prints.",
)
@click.option(
    "--save-script",
    "script",
    metavar="FILE.py",
    help="Write the frame as a script, with its data in FILE.npz.",
)
@click.option("--video", metavar="FILE", help="Write the frames as an animation: .png, .webp or .mp4.")
@click.option(
    "--fps", type=click.IntRange(1, 60), metavar="N", default=25, help="Frames per second of --video."
)
@threads_option
def replay(
    trace,
    profile,
    frames,
    out,
    size,
    list_only,
    checked,
    beside,
    page,
    json_file,
    script,
    video,
    fps,
    threads,
):
    """Draw frames of FILE.trace, which apitrace recorded, or of standard input (-), as PNG files.

    A frame ends when its window swaps its buffers. In a single-buffered window it ends at glFlush or glFinish
    after a draw. FrameTerminatorGREMEDY, the end of the context and the end of the trace end it too. Every
    frame's line has the SHA-256 digest of its pixels.

    At the end a summary says what happened to the calls: drawn, without effect, ignored as OpenGL ignores
    them, refused (each in a sentence), left out as undefined, or unknown.

    Exit status: 0 if everything was drawn; 1 if a call was refused or is unknown, or an answer differs; 2 if
    the trace cannot be read, or lacks a frame.
    """
    from fixedpipe.effects.cli.replay_beside import check_beside
    from fixedpipe.effects.cli.replay_list import tell_list
    from fixedpipe.effects.cli.replay_page import write_page
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.effects.replays.asked import FramesAsked

    context = click.get_current_context()
    with refusals():
        asked = FramesAsked.of(frames)
    with refusals():
        window = _size(size)
    if list_only:
        names = "frames", "out", "checked", "beside", "page", "script", "video", "fps", "threads"
        refuse_ignored(context, names, "--list draws nothing; leave it out")
        tell_list(trace, profile, window, json_file)
        return
    if video is None:
        refuse_ignored(context, ("fps",), "it is of an animation; give --video FILE")
    if page is not None:
        names = "out", "size", "checked", "beside", "json_file", "script", "video", "fps"
        refuse_ignored(context, names, "--page writes nothing but the page; leave it out")
        machine_of(profile or _USUAL)
        write_page(trace, profile or _USUAL, asked, page, threads)
        return
    if beside is not None:
        check_beside(trace, window)
    files = _Files(trace, profile or _USUAL, asked, out, json_file, script, video, fps)
    if window is not None and max(window) > (largest := files.machine.framebuffers.max_viewport):
        raise Refusal(f"--size is {size}; the {files.machine.name} draws up to {largest}x{largest} pixels.")
    context.exit(_draw(files, window, checked, beside is not None, threads))


def _size(text):
    """(width, height) of ``WxH``; None: none was given. Raises Refusal."""
    from fixedpipe.effects.refusal import Refusal

    if text is None:
        return None
    width, times, height = text.lower().partition("x")
    if not (times and width.isdecimal() and height.isdecimal() and int(width) and int(height)):
        raise Refusal(f"--size is {text!r}; give width and height in pixels, as 640x480.")
    return int(width), int(height)


class _Files:
    """The files that a replay reads and writes. The constructor checks that they are writable. Raises
    Refusal.
    """

    def __init__(self, trace, key, asked, out, json_file, script, video, fps):
        from fixedpipe.effects.presentation.movies import kind_of
        from fixedpipe.effects.refusal import Refusal
        from fixedpipe.effects.reports.files import writable_file, writable_folder

        self.trace, self.key, self.asked, self.fps = trace, key, asked, fps
        self.machine = machine_of(key)
        self.stem = "trace" if trace == "-" else Path(trace).name.removesuffix(".trace")
        self.json = writable_file(json_file) if json_file else None
        self.script = Path(script) if script is not None else None
        if self.script is not None:
            if asked.count != 1:
                raise Refusal("--save-script writes one frame; give its number, as --frames 12.")
            if self.script.suffix != ".py":
                raise Refusal(f"The name {script} must end with .py.")
            writable_file(self.script)
            writable_file(self.script.with_suffix(".npz"))
        self.video = Path(video) if video is not None else None
        if self.video is not None:
            kind_of(self.video)
            writable_file(self.video)
            if asked.count is None and self.video.suffix.lower() != ".mp4":
                raise Refusal(
                    f"{self.video} says at its beginning how many frames it has; give --frames with numbers, "
                    "as 0-99, or name it .mp4."
                )
        self.folder = writable_folder(out)

    def picture(self, frame):
        """The path of a frame's picture."""
        return self.folder / f"{self.stem}-{self.key}-{frame.number}.png"


def _draw(files, window, checked, beside, threads):
    """Draw the frames that the user asked for, and print the summary. Returns the exit status."""
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.replay_beside import tell_beside
    from fixedpipe.effects.replays.check import Check
    from fixedpipe.effects.replays.driving import frames_of, opened
    from fixedpipe.effects.replays.replay import Replay
    from fixedpipe.effects.replays.summary import is_refused, summary_data, summary_lines
    from fixedpipe.effects.reports.files import write_whole
    from fixedpipe.pipeline.messages import count

    asked, check = files.asked, Check() if checked else None
    replay = Replay(
        files.machine,
        wanted=asked.wants,
        needed=asked.may_want,
        recorded=asked.may_want if files.script else lambda number: False,
        size=window,
        check=check,
        threads=threads,
    )
    records = []
    with opened(files.trace) as (trace, share):
        announce_compiling()
        with _progress(asked, share) as (say, step):
            frames = frames_of(trace, replay, asked, to_the_end=checked)
            pictures = _pictures(files, frames, records, say, step)
            if files.video is None:
                for _ in pictures:
                    pass
            else:
                _write_video(files, pictures)
        damage, unfinished = trace.damage, trace.unfinished
    found = [record["frame"] for record in records]
    if beside:
        tell_beside(files, records)
    draws = f"{count(replay.frames, 'frame')} with {count(replay.draws, 'draw')}"
    click.echo(f"{count(replay.calls, 'call')} read, {draws}.")
    for line in summary_lines(replay.tally):
        click.echo(line)
    if check is not None:
        click.echo(f"{check}.")
        for difference in check.differences:
            click.echo(f"  {difference}")
    if files.json is not None:
        record = {
            "trace": files.trace,
            "profile": files.key,
            "calls": replay.calls,
            "frames": records,
            "summary": summary_data(replay.tally),
            "damage": damage,
        }
        if check is not None:
            record["check"] = {
                "compared": check.compared,
                "differing": check.differing,
                "differences": [str(difference) for difference in check.differences],
                "counts": check.counts,
                "equal_counts": check.equal_counts,
            }
        write_whole(files.json, (json.dumps(record, indent=1) + "\n").encode())
    if replay.tally.count("refused") and files.trace != "-":
        click.echo(f"fixedpipe replay {files.trace} --list says what other machines would refuse.", err=True)
    missing = _tell_missing(files, replay, found, damage, unfinished)
    return 2 if missing else int(is_refused(replay.tally) or bool(check and check.differing))


def _pictures(files, frames, records, say, step):
    """Write a picture of each frame that the user asked for, and yield its pixels."""
    from fixedpipe.effects.reports.files import write_whole
    from fixedpipe.pipeline.framebuffers.pictures import png
    from fixedpipe.pipeline.golden.digests import digest
    from fixedpipe.pipeline.messages import count

    for frame in frames:
        step(frame)
        if not files.asked.wants(frame.number, frame.draws):
            continue
        path = files.picture(frame)
        write_whole(path, png(frame.image))
        record = {
            "frame": frame.number,
            "window": frame.window,
            "first_call": frame.first_call,
            "last_call": frame.last_call,
            "seen_call": frame.seen_call,
            "ended": frame.ended,
            "draws": frame.draws,
            "refused_draws": frame.refused,
            "width": frame.width,
            "height": frame.height,
            "picture": str(path),
            "sha256": digest(frame.image),
        }
        records.append(record)
        refused = f", {frame.refused} of them refused" if frame.refused else ""
        say(
            f"frame {frame.number}: {count(frame.draws, 'draw')}{refused} in calls {frame.first_call} to "
            f"{frame.last_call}; {path}, {frame.width}x{frame.height}, sha256 {record['sha256']}"
        )
        if files.script is not None:
            _write_script(files, frame, say)
        yield frame.image[..., :3]


def _write_script(files, frame, say):
    from fixedpipe.effects.replays.recording import frame_commands
    from fixedpipe.effects.replays.scripts import npz_bytes, script_text
    from fixedpipe.effects.reports.files import write_whole

    commands = frame_commands(frame.recording, frame.shown)
    title = f"Frame {frame.number} of {Path(files.trace).name} on the {files.machine.name}"
    text, arrays = script_text(commands, files.key, frame.width, frame.height, title)
    beside = files.script.with_suffix(".npz")
    write_whole(files.script, text.encode())
    write_whole(beside, npz_bytes(arrays))
    say(f"{files.script} and {beside}: the frame's {len(commands)} commands and their data")


def _write_video(files, pictures):
    from fixedpipe.effects.presentation.movies import write_animation
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.effects.reports.files import written_whole

    started = next(pictures, None)
    if started is None:
        return  # a sentence says which frames the trace lacks

    def same_size():
        first = None
        for picture in chain((started,), pictures):
            first = picture.shape if first is None else first
            if picture.shape != first:
                raise Refusal("The frames have several sizes, and an animation has one; give --size.")
            yield picture

    with refusals(), written_whole(files.video) as temporary:
        write_animation(temporary, same_size(), files.asked.count, files.fps, True)


def _tell_missing(files, replay, found, damage, unfinished):
    """Print what the trace lacks. Returns whether the user asked for some of it."""
    from fixedpipe.effects.replays.driving import no_such_frame
    from fixedpipe.pipeline.messages import count

    if damage is not None:
        click.echo(f"fixedpipe: {damage}", err=True)
    if unfinished:
        click.echo(f"fixedpipe: {count(unfinished, 'call')} of the trace did not end.", err=True)
    missing = files.asked.missing(found)
    if missing:
        click.echo(f"fixedpipe: {files.trace} {no_such_frame(missing[0], replay.frames)}", err=True)
    elif files.asked.ranges is None and not found:
        click.echo(f"{files.trace} {no_such_frame(None, replay.frames)}")
    everything = files.asked.last is None and files.asked.count is None
    return bool(missing) or (damage is not None and (everything or not found))


@contextmanager
def _progress(asked, share):
    """Yields two functions. One prints a line. The other shows that a frame has ended, on the progress bar of
    a terminal.
    """
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    console = error_console()
    if not console.is_terminal:
        yield click.echo, lambda frame: None
        return
    columns = BarColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn()
    with Progress(*columns, console=console, transient=True, redirect_stdout=False) as progress:
        task = progress.add_task("reading", total=None)

        def step(frame):
            done = share() if asked.last is None else (frame.number + 1) / (asked.last + 1)
            total = None if done is None else 1.0
            said = f"frame {frame.number}, call {frame.last_call}"
            progress.update(task, description=said, completed=done or 0.0, total=total)

        def above_the_bar(line):
            console.print(line, markup=False, soft_wrap=True)

        # If the output is piped, it goes to the pipe. On the same terminal it must not overwrite the bar.
        yield above_the_bar if sys.stdout.isatty() else click.echo, step
