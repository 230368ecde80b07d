"""Instructions (and cycles, where the processor counts them) of a fragment: numbers that no load disturbs.

``python -m bench counters [SCENE ...] [--cpu NAME]``. Counted by ``perf stat`` where it can, else by
Valgrind, which runs every instruction in software and knows AVX2, but not AVX-512. Each party draws on one
thread in a process of its own, once few frames and once more; the difference is of the frames alone.
"""

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

from bench import kinds, limits, processor
from bench.peers.mesa import environment as mesa_environment
from bench.peers.mesa import missing
from bench.scenes import SCENES
from bench.starting import environment

DEFAULT = ("b", "f3", "e2")
FEW, MORE = 2, 10
PERF = ("perf", "stat", "-x", ",", "-e", "instructions:u,cycles:u")
# The code that both compile is on no file, and replaced while they run.
VALGRIND = (
    "valgrind",
    "--tool=cachegrind",
    "--cache-sim=no",
    "--cachegrind-out-file=/dev/null",
    "--smc-check=all-non-file",
)
# Valgrind has no AVX-512, so that neither party may use it.
_VALGRINDS = ("avx2", "generic")


def _counted_by_perf(text):
    """{"instructions": n, "cycles": n} of ``perf stat -x ,``; without those that it could not count."""
    found = {}
    for line in text.splitlines():
        value, _, name = (*line.split(","), "", "")[:3]
        if value.isdigit():
            found[name.partition(":")[0]] = int(value)
    return found


def _counted_by_valgrind(text):
    """{"instructions": n} of what Valgrind says at its end."""
    said = re.search(r"I\s+refs:\s+([\d,]+)", text)
    return {"instructions": int(said[1].replace(",", ""))} if said else {}


def by_perf(command, variables):
    """What ``perf stat`` counts of a command; empty where it counts nothing. OSError if the command fails."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "counted")
        _finish([*PERF, "-o", str(file), "--", *command], variables)
        return _counted_by_perf(file.read_text() if file.exists() else "")


def by_valgrind(command, variables):
    """What Valgrind counts of a command. OSError if the command fails."""
    return _counted_by_valgrind(_finish([*VALGRIND, *command], variables))


def _finish(command, variables):
    """Run a command to its end; what it said on standard error. OSError if it ends with an error."""
    ended = subprocess.run(command, env=environment(**variables), capture_output=True, text=True)
    if ended.returncode:
        raise OSError(f"{' '.join(command)} ended with {ended.returncode}: {ended.stderr[-500:]}")
    return ended.stderr


def choose(limit):
    """What counts on this machine: ``by_perf`` or ``by_valgrind``. OSError says why neither can."""
    if shutil.which("perf"):
        try:
            if by_perf([sys.executable, "-c", ""], {}):
                return by_perf
        except OSError:
            pass  # it is there, but may not count
    if not shutil.which("valgrind"):
        raise OSError("perf counts no instructions here, and valgrind is not installed.")
    if limit not in _VALGRINDS:
        raise OSError(
            "perf counts no instructions here, and valgrind knows no AVX-512: give --cpu avx2 or generic."
        )
    return by_valgrind


def count(counter, party, scene, size):
    """{"instructions": of a fragment or triangle, ...} of a party ("ours", "llvmpipe"), as a float."""
    variables = _variables(party)
    command = [sys.executable, "-m", "bench.counted", party, scene.name, str(size)]
    if party == "ours":
        _finish([*command, "0"], variables)  # compiles what the cache lacks
    few, more = (counter([*command, str(frames)], variables) for frames in (FEW, MORE))
    work = scene.work(size) * (MORE - FEW)
    return {name: (more[name] - few[name]) / work for name in few.keys() & more.keys()}


def main(arguments):
    """``python -m bench counters``: returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m bench counters",
        description="Instructions of a fragment (e, e2: of a triangle), ours and llvmpipe's, on one thread: "
        "numbers that other programs' load does not change.",
    )
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"{', '.join(DEFAULT)} when none is named")
    parser.add_argument("--cpu", choices=limits.LIMITS, help="limit both to a processor's vectors")
    parser.add_argument("--json", metavar="FILE", help="also write them as one object")
    parser.add_argument("--kinds", action="store_true", help="by kind, of what each compiles while it runs")
    options = parser.parse_args(arguments)
    options.scenes = options.scenes or DEFAULT
    if unknown := [name for name in options.scenes if name not in SCENES]:
        parser.error(f"there is no scene {', '.join(unknown)}; the scenes are {', '.join(SCENES)}.")
    own = processor.read()
    if options.cpu and (lacking := limits.refusal(options.cpu, own)):
        parser.error(lacking)
    if options.cpu and limits.current() != options.cpu:
        return limits.run_again(options.cpu, ["counters", *arguments])
    try:
        found = _kinds(options, own) if options.kinds else _table(choose(options.cpu), options, own)
    except OSError as problem:
        print(problem, file=sys.stderr)
        return 1
    if options.json:
        Path(options.json).write_text(json.dumps(found, indent=2) + "\n")
    return 0


def _table(counter, options, own):
    """Count and print; the object of ``--json``."""
    how = {by_perf: "perf", by_valgrind: "valgrind"}[counter]
    print(f"{own}; counted by {how}")
    if options.cpu:
        print(f"--cpu {options.cpu}: {limits.LIMITS[options.cpu].means}")
    parties = _parties()
    units = ("instructions", "cycles") if counter is by_perf else ("instructions",)
    names = [f"{party}, {what}" for what in units for party in parties]
    print("\n" + _row("scene", "of a", *names))
    print(_row(*["---"] * (2 + len(names))))
    rows = []
    for name in options.scenes:
        scene = SCENES[name]
        counted = {party: count(counter, party, scene, scene.size) for party in parties}
        shown = [counted[party].get(what) for what in units for party in parties]
        of = _counted_in(scene)
        print(_row(name, of, *("-" if n is None else f"{n:.3g}" for n in shown)), flush=True)
        rows.append({"scene": name, "of": of, **counted})
    return {
        "date": processor.today(),
        "processor": own.as_json(),
        "cpu": options.cpu,
        "by": how,
        "scenes": rows,
    }


def _kinds(options, own):
    """Count by kind and print; the object of ``--json``."""
    for program in ("valgrind", "objdump"):
        if not shutil.which(program):
            raise OSError(f"--kinds needs {program}, which is not installed.")
    if options.cpu not in _VALGRINDS:
        raise OSError("--kinds counts by valgrind, which knows no AVX-512: give --cpu avx2 or generic.")
    names = ("all", "stack", *kinds.KINDS, "scalars")
    print(_row("scene", "of a", "whose", *names) + "\n" + _row(*["---"] * (3 + len(names))))
    rows = []
    for name in options.scenes:
        scene, of = SCENES[name], _counted_in(SCENES[name])
        for party in _parties():
            variables = _variables(party)
            command = [sys.executable, "-m", "bench.counted", party, name, str(kinds.EDGE)]
            if party == "ours":
                _finish([*command, "0"], variables)  # compiles what the cache lacks
            found = kinds.count(partial(_finish, variables=variables), command, scene.work(kinds.EDGE))
            print(_row(name, of, party, *(f"{found[kind]:.3g}" for kind in names)), flush=True)
            rows.append({"scene": name, "of": of, "party": party, **found})
    return {"date": processor.today(), "processor": own.as_json(), "cpu": options.cpu, "kinds": rows}


def _parties():
    """Who can draw here: ours, and llvmpipe; says why where it cannot."""
    if lacking := missing():
        print(f"Without llvmpipe: {' '.join(lacking)}", file=sys.stderr)
        return ("ours",)
    return ("ours", "llvmpipe")


def _variables(party):
    """What the party's process has in its environment."""
    mesa = mesa_environment(1) | limits.peer_variables() if party == "llvmpipe" else {}
    return {"PYTHONHASHSEED": "0"} | mesa


def _counted_in(scene):
    return "triangle" if scene.unit == "Mtriangles/s" else "fragment"


def _row(*cells):
    return f"| {' | '.join(cells)} |"
