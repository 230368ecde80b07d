"""``fixedpipe replay --list``: print what a trace contains, and which calls each machine would refuse."""

import json

import click

from fixedpipe.effects.cli.options import machine_of

_MOST_TOLD = 3  # sentences of a machine, if several machines are listed


def tell_list(path, profile, window, json_file):
    """Print what a trace contains, and which calls machines would refuse. Raises Refusal."""
    from fixedpipe.effects.replays.driving import opened
    from fixedpipe.effects.replays.listing import Listing
    from fixedpipe.effects.reports.files import writable_file, write_whole
    from fixedpipe.pipeline.profiles import PROFILES

    machines = {key: each for key, each in PROFILES.items() if not each.arithmetic.exact}
    if profile is not None:
        machines = {profile: machine_of(profile)}
    json_path = writable_file(json_file) if json_file else None
    listing = Listing(machines, window)
    with opened(path) as (trace, _):
        for call in trace:
            listing.take(call)
        listing.finish()
        damage, version = trace.damage, trace.version
    for line in _lines_of(path, version, listing, profile):
        click.echo(line)
    if damage is not None:
        click.echo(f"fixedpipe: {damage}", err=True)
    if json_path is not None:
        record = {"trace": path, "version": version, "damage": damage, **listing.data()}
        if profile is None:
            record["recommended"] = listing.recommended()
        write_whole(json_path, (json.dumps(record, indent=1) + "\n").encode())


def _lines_of(path, version, listing, profile):
    from fixedpipe.effects.replays.summary import outcome_line
    from fixedpipe.pipeline.messages import count

    replay = listing.replay
    yield (
        f"{path}: a trace of version {version}, {count(replay.calls, 'call')}, "
        f"{count(replay.frames, 'frame')}, {count(replay.draws, 'draw')}"
    )
    sizes = [f"{w}x{h} ({count(n, 'frame')})" for (w, h), n in listing.sizes.most_common()]
    if sizes:
        yield f"sizes: {', '.join(sizes)}"
    functions = [f"{name} {times}" for name, times in listing.functions.most_common()]
    yield f"{count(len(functions), 'function')}: {', '.join(functions)}"
    yield f"extensions: {', '.join(listing.extensions) or 'none that is known here'}"
    yield ""
    yield f"What machines would refuse of the first {count(listing.judged, 'frame')} that draw something:"
    for key, verdict in listing.verdicts.items():
        draws = f", of {verdict.draws} draws {verdict.refused_draws}" if verdict.refused_draws else ""
        refused = f"{count(verdict.count, 'call')}{draws}" if verdict.count else "nothing"
        without = f"; it draws without {count(len(verdict.without), 'feature')}" if verdict.without else ""
        yield f"{key:20} {refused}{without}"
        sentences = (*verdict.refusals, *verdict.without)
        told = sentences if profile is not None else sentences[:_MOST_TOLD]
        for outcome in told:
            yield outcome_line(outcome)
        if len(told) < len(sentences):
            more = count(len(sentences) - len(told), "other sentence")
            yield f"  and {more}; --profile {key} has all"
    if profile is None:
        yield ""
        yield f"recommended: {listing.recommended()}"
