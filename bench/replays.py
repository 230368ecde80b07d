"""``python -m bench replay FILE.trace ...``: a frame of recorded programs, ours beside glretrace on llvmpipe.

Both replay the last whole frame of a trace again and again, on as many threads each. glretrace does so by its
``--loop``; its time is that of many rounds less that of few, so that loading is in neither.

Ours is measured three times: the trace is read; its calls become commands, which nobody runs; a machine runs
them too. The differences are the parts: reading, front end, machine. Each is the least of several rounds.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from bench import processor
from fixedpipe.effects.refusal import Refusal
from fixedpipe.effects.replays import glretrace
from fixedpipe.effects.replays.driving import opened
from fixedpipe.effects.replays.replay import Replay
from fixedpipe.effects.replays.targets import Drawn, Target
from fixedpipe.pipeline.profiles import PROFILES

ROUNDS = 5
# Repetitions of a round: as many as take this long, between these bounds.
_ROUND_SECONDS, _MOST_REPETITIONS = 0.5, 200
# Rounds of glretrace's --loop.
FEW, MORE = 10, 110


@dataclass(frozen=True)
class Times:
    """Milliseconds a frame: of the processor, all threads together, and of the wall's clock."""

    processor: float
    wall: float

    def __sub__(self, other):
        return Times(self.processor - other.processor, self.wall - other.wall)

    def __add__(self, other):
        return Times(self.processor + other.processor, self.wall + other.wall)


@dataclass(frozen=True)
class Row:
    """A trace's frame, and what it takes. ``peer``: glretrace on llvmpipe; None: not measured.

    ``refused``: calls of the frame that the machine or the front end refuses.
    """

    trace: str
    machine: str
    frame: int
    width: int
    height: int
    calls: int
    draws: int
    refused: int
    reading: Times
    front_end: Times
    machine_time: Times
    peer: Times | None

    @property
    def ours(self):
        """All three parts."""
        return self.reading + self.front_end + self.machine_time


class Undrawn(Target):
    """A Target that takes commands, and does nothing with them."""

    def _start(self):
        pass

    def _execute(self, commands):
        return commands


def _clocks():
    return time.process_time(), time.perf_counter()


def _since(begun, repetitions):
    processor_time, wall = _clocks()
    return Times(
        *[1e3 * (now - then) / repetitions for now, then in zip((processor_time, wall), begun, strict=True)]
    )


def _least(rounds):
    """The least of each clock."""
    return Times(min(each.processor for each in rounds), min(each.wall for each in rounds))


class _LastFrame:
    """The last whole frame of a trace: its number, its calls, and what reading it takes."""

    def __init__(self, path, profile):
        replay, calls, last = Replay(profile, target=Undrawn), [], None
        with opened(path) as (trace, _):
            for call in trace:
                calls.append(call)
                for frame in replay.take(call):
                    if frame.draws:
                        last, kept = frame, calls
                    calls = []
        if last is None:
            raise Refusal(f"{path} has no frame that a call ends and that draws something.")
        self.path, self.frame, self.calls = path, last, kept
        self.reading = _least([self._read() for _ in range(ROUNDS)])

    def _read(self):
        """The time of reading the calls once, up to the frame's end."""
        first, last = self.calls[0].number, self.frame.last_call
        with opened(self.path) as (trace, _):
            for call in trace:
                if call.number >= first:
                    break
            begun = _clocks()
            for call in trace:
                if call.number >= last:
                    break
            return _since(begun, 1)

    def repeated(self, profile, kind, threads):
        """(milliseconds of the frame's calls on a Target, how many of them are refused)."""
        replay = Replay(profile, wanted=lambda *_: False, target=kind, threads=threads)
        with opened(self.path) as (trace, _):
            for call in trace:
                replay.take(call)
                if call.number >= self.frame.last_call:
                    break
        # The first repetition stores what the frame changes, and says how many make a round.
        before, begun = replay.tally.count("refused"), _clocks()
        self._take(replay)
        refused = replay.tally.count("refused") - before
        once = max(_since(begun, 1).wall / 1e3, 1e-6)
        repetitions = int(min(max(_ROUND_SECONDS / once, 1), _MOST_REPETITIONS))
        rounds = []
        for _ in range(ROUNDS):
            begun = _clocks()
            for _ in range(repetitions):
                self._take(replay)
            rounds.append(_since(begun, repetitions))
        return _least(rounds), refused

    def _take(self, replay):
        for call in self.calls:
            replay.take(call)


def _peer(path, last_call, threads):
    """Milliseconds a frame of glretrace, of the trace up to a call. Raises GlretraceError, OSError."""
    with glretrace.display() as shown, tempfile.TemporaryDirectory() as folder:
        trimmed = str(Path(folder, "trimmed.trace"))
        command = ["apitrace", "trim", f"--calls=0-{last_call}", f"--output={trimmed}", path]
        subprocess.run(command, check=True, capture_output=True)
        few, more = (
            _least([_looped(shown, trimmed, loops, threads) for _ in range(2)]) for loops in (FEW, MORE)
        )
    both = more - few
    return Times(both.processor / (MORE - FEW), both.wall / (MORE - FEW))


def _looped(shown, path, loops, threads):
    """Milliseconds of glretrace as a whole, with its last frame repeated."""
    begun = time.perf_counter()
    process = subprocess.Popen(
        ["glretrace", "-b", f"--loop={loops}", path],
        env=glretrace.environment(shown, threads),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise glretrace.GlretraceError(f"glretrace ended with status {process.returncode}.")
    return Times(1e3 * (used.ru_utime + used.ru_stime), 1e3 * (time.perf_counter() - begun))


def measure(path, key, threads, beside):
    """The Row of a trace's last whole frame on the machine ``key``. ``beside``: whether glretrace runs too.

    Raises Refusal, GlretraceError and OSError.
    """
    profile = PROFILES[key]
    last = _LastFrame(path, profile)
    front_end, _ = last.repeated(profile, Undrawn, threads)
    whole, refused = last.repeated(profile, Drawn, threads)
    return Row(
        trace=Path(path).name,
        machine=key,
        frame=last.frame.number,
        width=last.frame.width,
        height=last.frame.height,
        calls=len(last.calls),
        draws=last.frame.draws,
        refused=refused,
        reading=last.reading,
        front_end=front_end,
        machine_time=whole - front_end,
        peer=_peer(path, last.frame.last_call, threads) if beside else None,
    )


_HEADINGS = (
    *("trace", "machine", "pixels", "calls", "draws", "reading", "front end", "machine"),
    *("ours", "llvmpipe", "times", "wall: ours", "llvmpipe"),
)


def _cells(row):
    ours, peer = row.ours, row.peer
    yield from (row.trace, row.machine, f"{row.width}x{row.height}", row.calls)
    yield f"{row.draws}, {row.refused} calls refused" if row.refused else row.draws
    yield from (f"{each.processor:.2f}" for each in (row.reading, row.front_end, row.machine_time, ours))
    if peer is None:
        yield from ("-", "-", f"{ours.wall:.2f}", "-")
    else:
        yield from (f"{peer.processor:.2f}", f"{ours.processor / peer.processor:.1f}")
        yield from (f"{ours.wall:.2f}", f"{peer.wall:.2f}")


def main(arguments):
    """``python -m bench replay``: returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m bench replay",
        description="Processor milliseconds of a recorded program's last whole frame: ours, by parts, and "
        "glretrace's on llvmpipe. A column 'times' says how many times as long ours takes.",
    )
    parser.add_argument("traces", nargs="+", metavar="FILE.trace", help="traces of apitrace")
    parser.add_argument("--profile", choices=sorted(PROFILES), default="GEFORCE_256", help="machine")
    parser.add_argument("--threads", type=int, default=2, help="threads for both (2)")
    parser.add_argument("--alone", action="store_true", help="without glretrace")
    parser.add_argument("--json", metavar="FILE", help="also write everything as one object")
    options = parser.parse_args(arguments)
    if options.threads < 1:
        parser.error(f"--threads is {options.threads}; give 1 or more.")
    lacking = None if options.alone else glretrace.missing()
    if lacking is not None:
        print(f"Without glretrace: {lacking}", file=sys.stderr)
    own = processor.read()
    print(f"{own}; {options.threads} threads each; milliseconds of the processor a frame")
    print(_line(_HEADINGS) + "\n" + _line(["---"] * len(_HEADINGS)))
    rows, status = [], 0
    for path in options.traces:
        try:
            row = measure(path, options.profile, options.threads, not options.alone and lacking is None)
        except (Refusal, glretrace.GlretraceError, OSError, subprocess.CalledProcessError) as problem:
            print(f"{path}: {problem}", file=sys.stderr)
            status = 1
            continue
        print(_line(_cells(row)), flush=True)
        rows.append(asdict(row))
    if options.json:
        found = {
            "date": processor.today(),
            "processor": own.as_json(),
            "threads": options.threads,
            "rows": rows,
        }
        Path(options.json).write_text(json.dumps(found, indent=2) + "\n")
    return status


def _line(cells):
    return "| " + " | ".join(map(str, cells)) + " |"
