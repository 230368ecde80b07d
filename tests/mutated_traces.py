"""Damaged traces, replayed: no exception that is not ours, no process that a signal ends, bounded memory.

``python -m tests.mutated_traces --count 100000`` damages the kept traces of docs/examples, before or after
they are packed, and replays each. Most are validated alone (Judged); one in DRAWN is drawn. Worker processes
take a thousand each, with LIMIT bytes of memory. A failure is told with its seed, and ``--worker --seed S
--count 1`` repeats it.
"""

import argparse
import gzip
import io
import resource
import subprocess
import sys
import traceback
from pathlib import Path

import numpy as np

from fixedpipe.effects.replays.replay import Replay
from fixedpipe.effects.replays.targets import Drawn, Judged
from fixedpipe.pipeline.profiles import GEFORCE_256
from fixedpipe.pipeline.traces.calls import Trace, TraceError

FOLDER = Path(__file__).parents[1] / "docs" / "examples" / "traces"
BATCH = 1000
DRAWN = 50
# Bytes of a worker's data. Assumed: a Replay keeps 2^26 pixels at most (targets.py), some 600 MB, and numba
# takes as much again.
LIMIT = 3 << 30
# Every window's pixels, so that time goes into damage and not into filling.
_SIZE = (48, 32)
_KINDS = ("bits", "bytes", "cut", "doubled", "removed", "exchanged", "extreme")
# Bytes that mean most: the largest and smallest, varints that go on, and kinds of values.
_EXTREMES = (
    b"\xff" * 9 + b"\x01",
    b"\x00" * 4,
    b"\x80" * 10,
    b"\x0b\xff\xff\xff\x7f",
    b"\x00\x00\xc0\x7f",
    b"\xff\xff\x7f\x7f",
)


def damaged(data, random):
    """Bytes with one to eight damages, by a Generator of random numbers."""
    data = bytearray(data)
    for _ in range(int(random.integers(1, 9))):
        if len(data) < 2:
            break
        at, length = int(random.integers(len(data))), int(random.integers(1, 33))
        kind = _KINDS[random.integers(len(_KINDS))]
        if kind == "bits":
            data[at] ^= 1 << int(random.integers(8))
        elif kind == "bytes":
            data[at] = int(random.integers(256))
        elif kind == "cut" and random.random() < 1 / 8:
            del data[at:]
        elif kind == "doubled":
            data[at:at] = data[at : at + length] * int(random.integers(1, 4))
        elif kind == "removed":
            del data[at : at + length]
        elif kind == "exchanged":
            other = int(random.integers(len(data)))
            data[at : at + length] = data[other : other + length]
        elif kind == "extreme":
            extreme = _EXTREMES[random.integers(len(_EXTREMES))]
            data[at : at + len(extreme)] = extreme
    return bytes(data)


def mutant(seed):
    """The damaged trace of a seed, as a file's bytes."""
    random = np.random.default_rng(seed)
    files = sorted(FOLDER.glob("*.trace"))
    packed = files[random.integers(len(files))].read_bytes()
    if random.random() < 1 / 16:
        return damaged(packed, random)
    return gzip.compress(damaged(gzip.decompress(packed), random), compresslevel=1)


def replay(data, drawn):
    """Replay a file's bytes; a TraceError, which says in a sentence what is wrong, is an answer."""
    taken = Replay(GEFORCE_256, size=_SIZE, target=Drawn if drawn else Judged, threads=1)
    try:
        with Trace(io.BytesIO(data)) as trace:
            for call in trace:
                taken.take(call)
    except TraceError:
        return
    taken.finish()


def work(first, count):
    """Replay the mutants of ``count`` seeds; exit status 1 at the first that raises anything."""
    resource.setrlimit(resource.RLIMIT_DATA, (LIMIT, LIMIT))
    for seed in range(first, first + count):
        print(seed, flush=True)
        try:
            replay(mutant(seed), seed % DRAWN == 0)
        except BaseException:
            traceback.print_exc()
            return 1
    return 0


def main(arguments):
    """Start workers; exit status 1 where one failed."""
    parser = argparse.ArgumentParser(
        prog="python -m tests.mutated_traces", description="Damaged traces, replayed."
    )
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0, help="the first one's")
    parser.add_argument(
        "--worker", action="store_true", help="replay here, without a process for each thousand"
    )
    options = parser.parse_args(arguments)
    if options.worker:
        return work(options.seed, options.count)
    failed, end = 0, options.seed + options.count
    first = options.seed
    while first < end:
        count = min(BATCH, end - first)
        command = [
            sys.executable,
            "-m",
            "tests.mutated_traces",
            "--worker",
            f"--seed={first}",
            f"--count={count}",
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            last = int((done.stdout.split() or [str(first)])[-1])
            print(f"seed {last}: status {done.returncode}\n{done.stderr[-2000:]}", flush=True)
            failed += 1
            first = last + 1
        else:
            first += count
            print(f"{first - options.seed} replayed, {failed} failed", flush=True)
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
