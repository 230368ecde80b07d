"""Rates of the scenes: ours and a peer's, taken in turn so that a disturbance meets both."""

import statistics
import time
from dataclasses import dataclass

from bench.scenes import Scene

TURNS = 9
TURN_SECONDS = 0.15
WARM_SECONDS = 0.3
# A spread above this means that something disturbed the turns.
DISTURBED = 0.1
# Between turns, so that a party's threads have gone to sleep before the other one is timed.
REST_SECONDS = 0.01


def clock_of(threads):
    """The clock of a party that draws on some threads: of one alone the processor's, which runs for nobody
    else; else the wall's.
    """
    return time.process_time if threads == 1 else time.perf_counter


class Repeated:
    """Commands run again and again on a machine, as a party to a measurement.

    ``clock``: as ``clock_of`` has it for the machine's threads.
    """

    name = "ours"

    def __init__(self, machine, commands, clock=time.perf_counter):
        self._machine, self._commands, self._clock = machine, commands, clock

    def turn(self, frames):
        """Seconds that ``frames`` runs of the commands took."""
        start = self._clock()
        for _ in range(frames):
            self._machine.run(self._commands)
        return self._clock() - start


class Ours:
    """The emulated machine as a party to a measurement: whole frames through ``Machine``."""

    name = "ours"

    def __init__(self, threads):
        self._threads = threads

    def prepare(self, scene, size):
        """Make ``scene`` at ``size`` x ``size`` pixels the one that is drawn, with its textures in place."""
        # numba is imported with it, which takes longer than everything that needs no drawing.
        from fixedpipe.pipeline.execution.machine import Machine

        self._machine = Machine(scene.profile, size, size, threads=self._threads)
        self._machine.run(scene.textures())
        frame = scene.frame(size, scene.layers)
        self._frames = Repeated(self._machine, frame, clock_of(self._threads))
        self._picture = scene.frame(size, scene.picture_layers)

    def turn(self, frames):
        """Seconds that ``frames`` measured frames took."""
        return self._frames.turn(frames)

    def picture(self):
        """{"color": uint8 [h, w, 4], "depth": uint32 [h, w], "stencil": uint8 [h, w]}, top row first."""
        self._machine.run(self._picture)
        framebuffer = self._machine.framebuffer
        return {name: getattr(framebuffer, name).copy() for name in ("color", "depth", "stencil")}


@dataclass(frozen=True)
class Row:
    """A scene's result: rates in ``scene.unit``, medians over the turns; ``peer`` None: not measured.

    ``goal``: the least ratio that is asked for, or None.
    ``spread``: the larger of the parties' (median / best - 1); above a tenth something disturbed the run.
    """

    scene: Scene
    size: int
    threads: int
    ours: float
    peer: float | None
    spread: float
    goal: float | None = None

    @property
    def ratio(self):
        """Our rate over the peer's, or None."""
        return None if self.peer is None else self.ours / self.peer

    @property
    def is_below(self):
        """Whether a ratio is asked for, was measured, and is not reached."""
        return None not in (self.ratio, self.goal) and self.ratio < self.goal

    def as_json(self):
        """The row as the objects of ``--json`` hold it; three decimals."""
        rounded = {
            name: None if value is None else round(value, 3)
            for name, value in (("ours", self.ours), ("peer", self.peer), ("ratio", self.ratio))
        }
        return {
            "scene": self.scene.name,
            "size": self.size,
            "threads": self.threads,
            "unit": self.scene.unit,
            **rounded,
            "goal": self.goal,
            "aim": self.scene.aim,
            "spread": round(self.spread, 3),
        }


def _warm(party, warm_seconds, turn_seconds):
    """Draw unmeasured, the first frame alone because it compiles; how many frames fill a turn."""
    party.turn(1)
    frames, spent = 0, 0.0
    while spent < warm_seconds or frames == 0:
        spent += party.turn(1)
        frames += 1
    return max(1, round(turn_seconds * frames / spent))


def take_turns(parties, turns=TURNS, turn_seconds=TURN_SECONDS, warm_seconds=WARM_SECONDS):
    """Seconds per frame of each party, one number a turn: a list of ``turns`` numbers for each party.

    A turn begins with a frame that is not measured, which wakes the party's threads.
    """
    frames = [_warm(party, warm_seconds, turn_seconds) for party in parties]
    seconds = [[] for _ in parties]
    for _ in range(turns):
        for party, count, taken in zip(parties, frames, seconds, strict=True):
            time.sleep(REST_SECONDS)
            party.turn(1)
            taken.append(party.turn(count) / count)
    return seconds


def spread_of(seconds):
    """How far the median of some turns lies above the best of them, as a share of it."""
    return statistics.median(seconds) / min(seconds) - 1


def summarize(scene, size, threads, seconds, goal=None):
    """The Row of ``take_turns``'s lists, ours first; ``goal`` as in it."""
    work = scene.work(size) / 1e6
    rates = [work / statistics.median(taken) for taken in seconds]
    spread = max(map(spread_of, seconds))
    return Row(scene, size, threads, rates[0], rates[1] if len(rates) > 1 else None, spread, goal)
