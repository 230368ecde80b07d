"""On what a run was measured: the processor, the packages, the commit, and how quiet it was."""

import importlib.metadata
import os
import platform
import subprocess
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

_ROOT = Path(__file__).resolve().parents[1]
CPUINFO, STAT = Path("/proc/cpuinfo"), Path("/proc/stat")
# Names of proc(5)'s flags, the widest vectors last; a level has all of its own and of those before it.
LEVELS = {
    "SSE2": ("sse2",),
    "AVX": ("avx",),
    "AVX2": ("avx2", "fma", "bmi1", "bmi2", "f16c"),
    "AVX-512": ("avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"),
}
# The kinds for which goals are asked (bench.goals).
ZEN_5, OTHER = "Zen 5", "other"
# Source: Linux, arch/x86/kernel/cpu/amd.c, bsp_init_amd: family 0x1a, but for later models of it.
_ZEN_5_FAMILY = 26
# Above this share of the cores' time, what others compute disturbs the measurement.
QUIET = 0.05


@dataclass(frozen=True)
class Processor:
    """What the system says of its processor.

    name           "AMD EPYC"
    vendor         "AuthenticAMD"; "" where the system does not say
    family, model  numbers of cpuid; None where the system does not say
    extensions     of ``LEVELS``, those that it has
    cores          that this process may use
    """

    name: str
    vendor: str
    family: int | None
    model: int | None
    extensions: tuple[str, ...]
    cores: int

    @property
    def kind(self):
        """ZEN_5 or OTHER: whose goals hold."""
        return ZEN_5 if (self.vendor, self.family) == ("AuthenticAMD", _ZEN_5_FAMILY) else OTHER

    @property
    def key(self):
        """What runs on the same kind of processor have in common: name, family and model, cores."""
        return f"{self.name} (family {self.family}, model {self.model}), {self.cores} cores"

    def __str__(self):
        widest = self.extensions[-1] if self.extensions else "unknown vectors"
        plural = "" if self.cores == 1 else "s"
        numbers = f" (family {self.family}, model {self.model})" if self.family is not None else ""
        return f"{self.cores} core{plural} of {self.name}{numbers}, {widest}"

    def as_json(self):
        """The object of ``--json`` and ``--history``."""
        return {
            "name": self.name,
            "vendor": self.vendor,
            "family": self.family,
            "model": self.model,
            "extensions": list(self.extensions),
            "cores": self.cores,
            "kind": self.kind,
        }


def read(cpuinfo=None):
    """The Processor of this machine, from ``/proc/cpuinfo`` or a text of its form; else its name alone."""
    if cpuinfo is None:
        try:
            cpuinfo = CPUINFO.read_text()
        except OSError:
            cpuinfo = ""
    said = {}
    for line in cpuinfo.splitlines():
        name, _, value = line.partition(":")
        said.setdefault(name.strip(), value.strip())
    flags = set(said.get("flags", "").split())
    extensions = []
    for level, needed in LEVELS.items():
        if not flags.issuperset(needed):
            break
        extensions.append(level)
    return Processor(
        name=said.get("model name") or platform.processor() or platform.machine(),
        vendor=said.get("vendor_id", ""),
        family=_number(said.get("cpu family")),
        model=_number(said.get("model")),
        extensions=tuple(extensions),
        cores=len(_own_cores()),
    )


def _number(text):
    return int(text) if text else None


def _own_cores():
    affinity = getattr(os, "sched_getaffinity", None)  # macOS has none
    return affinity(0) if affinity else set(range(os.cpu_count() or 1))


def versions():
    """name -> version of what compiles and computes."""
    found = {"Python": platform.python_version()}
    return found | {name: importlib.metadata.version(name) for name in ("numba", "llvmlite", "numpy")}


def commit():
    """The checkout's commit, 12 digits, and "+" where its files differ from it; "" outside of one."""
    try:
        said = [
            subprocess.run(["git", *words], cwd=_ROOT, capture_output=True, text=True, check=True).stdout
            for words in (["rev-parse", "--short=12", "HEAD"], ["status", "--porcelain", "-uno"])
        ]
    except (OSError, subprocess.CalledProcessError):
        return ""
    return said[0].strip() + ("+" if said[1].strip() else "")


def today():
    """The date and time of a run, UTC, to the minute, as ISO 8601 has it."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%MZ")


class Disturbance:
    """How much of the cores' time others took between its making and ``share``.

    Others are all processes but this one and those that it started and that have ended; and what the host of
    a virtual machine took ("steal").
    """

    def __init__(self, stat=STAT):
        self._stat = stat
        self._before = self._read()

    def _read(self):
        """(seconds of all cores that were busy, seconds in all, seconds of our own); None where unknown."""
        try:
            lines = self._stat.read_text().splitlines()
        except OSError:
            return None
        cores = {f"cpu{number}" for number in _own_cores()}
        busy = whole = 0
        for line in lines:
            name, *ticks = line.split()
            if name in cores:
                # Source: proc(5): user nice system idle iowait irq softirq steal; the rest is in user, nice.
                ticks = [int(tick) for tick in ticks[:8]]
                whole += sum(ticks)
                busy += sum(ticks) - ticks[3] - ticks[4]
        if not whole:
            return None
        hertz = os.sysconf("SC_CLK_TCK")
        return busy / hertz, whole / hertz, sum(os.times()[:4])

    def share(self):
        """Others' share of the cores' time since then, 0 .. 1; None where the system does not tell."""
        after = self._read()
        if None in (self._before, after):
            return None
        busy, whole, own = (b - a for a, b in zip(self._before, after, strict=True))
        return min(1.0, max(0.0, busy - own) / whole) if whole > 0 else None
