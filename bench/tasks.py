"""What tasks cost beside their work, how two processes share them, and a thousand cores by simulation.

``python -m bench.tasks overhead --executor processes:2`` measures what a task and a call cost the client.
``python -m bench.tasks drawing`` measures the frames of a sweep, and how long a process takes until them.
``python -m bench.tasks share`` draws a sweep's frames in one process and in two, in turns.
``python -m bench.tasks simulate`` computes how long a sweep takes on many cores, from such numbers.
"""

import argparse
import heapq
import json
import os
import random
import statistics
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from fixedpipe.effects.sweeps.sweep import sweep_of
from fixedpipe.effects.tasks import run as runs
from fixedpipe.effects.tasks.executors import opened
from fixedpipe.effects.tasks.manifest import Manifest
from fixedpipe.effects.tasks.run import run
from fixedpipe.effects.tasks.task import Task
from fixedpipe.effects.tasks.worker import batch

# A row as a figure's has it.
_ROW = {"width": 512, "height": 256, "sha256": "0" * 64, "rms": 1.25, "largest": 9.5, "differing": 12345}


def nothing(number):
    """A task without work, whose result is as long as a figure's row."""
    return _ROW


@dataclass(frozen=True)
class Costs:
    """Seconds of the client's processor.

    call  for each call to a worker
    task  for each task in a call: its digest, its pickle, its row in the manifest
    row   bytes of a row in the manifest
    """

    call: float
    task: float
    row: float


def measure_costs(executor: str, tasks: int = 2000, turns: int = 3) -> Costs:
    """Costs of tasks without work: the least of some turns, by calls of one task and of MOST_IN_A_CALL."""
    with opened(executor) as workers, tempfile.TemporaryDirectory() as folder:
        list(run(_nothings(20, -1), workers, workers=workers.workers))  # prepares the workers

        def seconds(size, turn):
            path = Path(folder) / f"{size}-{turn}"
            usual, runs.MOST_IN_A_CALL = runs.MOST_IN_A_CALL, size
            try:
                with Manifest(path, "nothing") as manifest:
                    begun = time.process_time()
                    done = sum(
                        1 for _ in run(_nothings(tasks, turn), workers, manifest, workers=workers.workers)
                    )
                    taken = time.process_time() - begun
            finally:
                runs.MOST_IN_A_CALL = usual
            return taken / done, path.stat().st_size / done

        single = min(seconds(1, turn)[0] for turn in range(turns))
        many, row = min(seconds(runs.MOST_IN_A_CALL, turn) for turn in range(turns))
        call = (single - many) / (1.0 - 1.0 / runs.MOST_IN_A_CALL)
        return Costs(call, many - call / runs.MOST_IN_A_CALL, row)


def _nothings(count, turn):
    return (Task(nothing, {"number": n}, "nothing", str(turn)) for n in range(count))


def processor_seconds(work=None, parameters=None):
    """In a worker: the seconds of a processor that a task's function takes; without one, those that the
    process has taken since it began.
    """
    begun = 0.0
    if work is not None:
        begun = time.process_time()
        work(**parameters)
    return time.process_time() - begun


def _frames(figure, vary, size):
    """The tasks of a sweep; ``vary``: NAME=VALUES, as --vary takes it."""
    name, _, values = vary.partition("=")
    return list(sweep_of(figure, {name: values}, size=size).tasks())


def measure_drawing(figure: str, vary: str, size: int | None) -> tuple[float, list[float]]:
    """(Seconds until a new process may draw, its kernels being compiled; seconds of each frame of a sweep),
    of a processor, so that neighbours do not count. The first frame, which imports modules, is left out.
    """
    tasks = _frames(figure, vary, size)
    with opened("processes:1", threads=1) as workers:
        start = workers.submit(processor_seconds).result()
        calls = [workers.submit(processor_seconds, task.work, dict(task.parameters)) for task in tasks]
        return start, [call.result() for call in calls][1:]


def measure_share(figure: str, vary: str, size: int | None, turns: int) -> dict[int, float]:
    """Wall seconds of a sweep's frames in one process and in two: the median of some turns, one after the
    other, so that both meet the same neighbours.
    """
    tasks = _frames(figure, vary, size)
    taken: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(turns):
        for count in (1, 2):
            with opened(f"processes:{count}", threads=1) as workers:
                for future in [
                    workers.submit(batch, [(t.work, dict(t.parameters))]) for t in tasks[: 2 * count]
                ]:
                    future.result()  # each process has its kernels then
                begun = time.perf_counter()
                for _ in run(iter(tasks), workers, workers=workers.workers):
                    pass
                taken[count].append(time.perf_counter() - begun)
    return {count: statistics.median(seconds) for count, seconds in taken.items()}


@dataclass(frozen=True)
class Simulated:
    """A sweep on many cores.

    seconds  from the first call to the last answer
    used     the share of all cores' seconds that draws frames
    client   the share of the time that the client works
    """

    seconds: float
    used: float
    client: float


def simulate(
    frames: int, cores: int, drawing: Sequence[float], size: int, costs: Costs, start: float = 0.0
) -> Simulated:
    """A sweep's calls, one after the other by one client, on cores that answer.

    drawing  seconds of frames that were measured, of which each frame takes one at random
    size     frames in a call
    costs    of the client
    start    seconds until a core draws its first frame: a process, its kernels, the self-test

    The client answers first whoever came first. It sends a core the next call when it takes the answer of the
    last, and in the beginning one call to each.
    """
    chance = random.Random(1)
    mean, spread, least = statistics.fmean(drawing), statistics.pstdev(drawing), min(drawing)
    left, clock, worked, drawn = frames, 0.0, 0.0, 0.0
    answers: list[float] = []  # when each core's answer comes
    waiting = cores
    while left or answers:
        if waiting and left:
            waiting -= 1
        else:
            came = heapq.heappop(answers)
            clock = max(clock, came)
            if not left:
                continue
        some = min(size, left)
        left -= some
        cost = costs.call + some * costs.task
        clock, worked = clock + cost, worked + cost
        # The sum of so many frames of random times, by the central limit theorem.
        work = max(some * least, chance.gauss(some * mean, spread * some**0.5))
        drawn += work
        heapq.heappush(answers, max(clock, start) + work)
    return Simulated(clock, drawn / (clock * cores), worked / clock)


def main(arguments: list[str] | None = None) -> None:
    """Measure or simulate, and print."""
    parser = argparse.ArgumentParser(prog="python -m bench.tasks", description=__doc__.split("\n\n")[0])
    parser.add_argument("what", choices=("overhead", "drawing", "share", "simulate"))
    parser.add_argument("--executor", default="processes:2", help="of overhead")
    parser.add_argument("--tasks", type=int, default=2000, help="of overhead")
    parser.add_argument("--figure", default="K12", help="of drawing and share")
    parser.add_argument("--vary", default="depth=0:0.4:40", help="of drawing and share: the frames")
    parser.add_argument("--size", type=int, help="of drawing and share: pixels an edge of a panel")
    parser.add_argument("--turns", type=int, default=3, help="of share")
    parser.add_argument("--frames", type=int, default=1_000_000, help="of simulate")
    parser.add_argument("--cores", type=int, default=1000, help="of simulate")
    parser.add_argument("--drawing", default="0.05,0.2", help="of simulate: seconds of a frame, several")
    parser.add_argument("--call", type=float, default=0.001, help="of simulate: client's seconds for a call")
    parser.add_argument("--task", type=float, default=0.0001, help="of simulate: for each of its tasks")
    parser.add_argument("--start", type=float, default=20.0, help="of simulate: seconds until a core draws")
    given = parser.parse_args(arguments)
    if given.what == "overhead":
        costs = measure_costs(given.executor, given.tasks)
        print(
            f"{given.executor}: {1e3 * costs.call:.3f} ms of the client for a call, "
            f"{1e3 * costs.task:.3f} ms for a task, {costs.row:.0f} bytes of the manifest for a row"
        )
    elif given.what == "share":
        half = measure_share(given.figure, given.vary, given.size, given.turns)
        busy = f"{os.getloadavg()[0]:.0f} processes ready on {os.cpu_count()} processors"
        print(
            f"1 process {half[1]:.2f} s, 2 processes {half[2]:.2f} s: {half[1] / half[2]:.2f} times ({busy})"
        )
    elif given.what == "drawing":
        start, frames = measure_drawing(given.figure, given.vary, given.size)
        quarters = (f"{q:.3f}" for q in (min(frames), *statistics.quantiles(frames), max(frames)))
        print(
            f"{start:.1f} s until the first frame; {len(frames)} frames: {', '.join(quarters)} s (quartiles)"
        )
    else:
        drawing, costs = json.loads(f"[{given.drawing}]"), Costs(given.call, given.task, 0.0)
        for size in (1, 4, 16, 64, 256):
            found = simulate(given.frames, given.cores, drawing, size, costs, given.start)
            print(
                f"{size:4} frames in a call: {found.seconds:8.0f} s, cores draw {found.used:4.0%} of it, "
                f"the client works {found.client:4.0%}",
                flush=True,
            )


if __name__ == "__main__":
    main()
