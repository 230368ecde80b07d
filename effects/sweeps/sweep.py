"""A sweep as a list of tasks, and its results as rows.

>>> from fixedpipe.effects.sweeps.sweep import sweep
>>> swept = sweep("F004-4", {"alpha_x": "0.25,0.5"}, size=8)
>>> [(row["machine"], row["alpha_x"], row["differing"] > 0) for row in swept.rows()]
[('GEFORCE_256', 0.25, True), ('GEFORCE_256', 0.5, True)]
"""

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from fixedpipe.effects.figures import FIGURES
from fixedpipe.effects.refusal import Refusal, choose, refusals
from fixedpipe.effects.reports.figure_inputs import inputs_of
from fixedpipe.effects.reports.own_figures import KIND, figure_of
from fixedpipe.effects.studies import STUDIES
from fixedpipe.effects.sweeps.grid import BITS, Axis, at, axis, bits_axis, kind_of_texts, points
from fixedpipe.effects.sweeps.points import figure_point, script_point, study_point
from fixedpipe.effects.sweeps.scripts import script_of
from fixedpipe.effects.tasks.environment import file_digest, file_digests, whole_inputs
from fixedpipe.effects.tasks.executors import of_user
from fixedpipe.effects.tasks.manifest import Manifest
from fixedpipe.effects.tasks.run import run
from fixedpipe.effects.tasks.task import Outcome, Task
from fixedpipe.pipeline.profiles import PROFILES

MACHINE, TASK = "machine", "task"
ALL, PAPER = "all", "paper"
# What ends every row: why it has no values, and how it came about.
_LAST = ("refused", "failed")
TIMES = ("seconds", "worker")


@dataclass(frozen=True)
class Sweep:
    """The tasks of a grid, and their rows.

    about    the sweep in words: "a sweep of F004-4"
    kind     "figure", "study" or "script", the name of the rows' first column
    subject  its id or path
    axes     the grid's: machines first, and the last varies fastest
    task_of  (values of the axes by name, the same as texts) -> Task
    left_out sentences on machines of ``all`` that have no part
    """

    about: str
    kind: str
    subject: str
    axes: tuple[Axis, ...]
    task_of: Callable[[Mapping[str, Any], Mapping[str, str]], Task]
    left_out: tuple[str, ...] = ()

    @cached_property
    def points(self) -> int:
        """How many points the grid has."""
        return points(self.axes)

    def tasks(self) -> Iterator[Task]:
        """The tasks in the grid's order, made one after the other."""
        for _, task in self._each():
            yield task

    def _each(self):
        for place in itertools.product(*(range(len(one.values)) for one in self.axes)):
            values, texts = at(self.axes, place)
            yield values, self.task_of(values, texts)

    def rows(self, manifest: Manifest, failed: Mapping[str, str], *, times: bool = True):
        """The rows in the grid's order: dicts with the columns that each has.

        failed  why a task has no result, by digest
        times   whether rows have ``seconds`` and ``worker``, which no two runs have alike
        """
        for values, task in self._each():
            outcome = manifest.find(task.digest)
            if outcome is None:
                outcome = Outcome(failed=failed.get(task.digest, "not computed"))
            own = dict(outcome.value or {})
            tables = own.pop("rows", None)
            last = {"refused": outcome.refused or None, "failed": outcome.failed or None}
            if times:
                last |= {"seconds": round(outcome.seconds, 6), "worker": outcome.worker or None}
            last[TASK] = task.digest[:16]
            head = {self.kind: self.subject, **values}
            for number, table in enumerate(tables if tables is not None else [{}]):
                numbered = {"row": number} if tables is not None else {}
                apart = {n if n not in head else f"{n} (table)": value for n, value in table.items()}
                yield {**head, **numbered, **apart, **own, **last}


def sweep_of(
    what: str,
    varied: Mapping[str, str],
    machines: Sequence[str] = (PAPER,),
    *,
    size: int | None = None,
    settings: Mapping[str, str] | None = None,
    checks: bool = False,
    reference: bool = False,
    pictures: bool = False,
) -> Sweep:
    """The Sweep of a figure, a study or a script.

    what       a figure's id or FILE.py with a FIGURE, a study's id, or SCRIPT.py
    varied     the values of an axis by its name, as ``grid.axis`` reads them: "bits", or a parameter
    machines   keys of PROFILES, "paper": the subject's own, or "all": every machine that can draw it
    size       a panel's height in pixels; None: the figure's own
    settings   other values of parameters at all points, as --set takes them
    checks     whether acceptance is measured; for a figure, only with its own values of parameters
    reference  whether a figure is compared with its reference
    pictures   whether tasks make a picture as well

    Raises Refusal for anything else, before anything is computed.
    """
    asked = _Asked(what, dict(varied), tuple(machines), size, dict(settings or {}))
    if what in STUDIES:
        return _of_study(asked, checks, reference or pictures)
    if what.endswith(KIND) and not _holds_figure(what):
        return _of_script(asked, checks or reference, pictures)
    if what not in FIGURES and not what.endswith(KIND):
        choose("figure, study or script", what, (*FIGURES, *STUDIES))
    return _of_figure(asked, checks, reference, pictures)


@dataclass(frozen=True)
class _Asked:
    what: str
    varied: dict[str, str]
    machines: tuple[str, ...]
    size: int | None
    settings: dict[str, str]

    def bits(self):
        """The Axis of bits in a tuple; empty where they are not varied."""
        return (bits_axis(self.varied[BITS]),) if BITS in self.varied else ()

    def parameters(self):
        """The varied texts by name, without bits."""
        return {name: text for name, text in self.varied.items() if name != BITS}

    def machine_axis(self, able, own, also=()):
        """The Axis of machines. ``able``: "all" of them; ``own``: what "paper" is; ``also``: others that may
        be named. Raises Refusal.
        """
        names: dict[str, None] = {}
        for name in self.machines:
            if name == ALL:
                names |= dict.fromkeys(able)
            else:
                key = own if name == PAPER else name
                choose("machine", key, PROFILES)
                if key not in (*able, *also):
                    raise Refusal(f"{self.what} cannot be drawn on {key}; it can on {', '.join(able)}.")
                names[key] = None
        if BITS in self.varied:
            for name in names:
                if PROFILES[name].arithmetic.exact:
                    raise Refusal(f"{name} is no machine, and its numbers have no width; leave it out.")
        return Axis(MACHINE, tuple(names), tuple(names))


def _file_of(what):
    try:
        return file_digest(what)
    except (OSError, ValueError) as error:
        raise Refusal(f"{what} cannot be read: {getattr(error, 'strerror', None) or error}.") from error


def _holds_figure(path):
    """Whether a file of a user's names a FIGURE, at the top of it."""
    _file_of(path)
    return "\nFIGURE" in "\n" + Path(path).read_text(errors="replace")


def _said(values):
    return " ".join(f"{name}={value}" for name, value in values.items())


def _of_figure(asked, checks, reference, pictures):
    figure = figure_of(asked.what)
    own_file = asked.what.endswith(KIND)
    file = _file_of(asked.what) if own_file else None
    if checks and (asked.parameters() or asked.settings):
        raise Refusal(
            f"--check holds for {figure.id}'s own values; vary machines and bits alone, or leave it out."
        )
    with refusals():
        figure.dimensions(asked.size)
    machines = asked.machine_axis(figure.machines, figure.machines[0], ("IDEAL",))
    machines, left_out = _with_parameters(asked, figure, machines)
    method = figure.method(machines.values[0])
    axes = [machines]
    for name, text in asked.varied.items():
        if name == BITS:
            axes += asked.bits()
            continue
        if name in asked.settings:
            raise Refusal(f"{name} is varied, so --set {name} would be ignored; leave one of them out.")
        with refusals():
            kind = figure.offer(name, method).kind
        axes.append(axis(name, text, getattr(kind, "kind", kind), f"{figure.id}'s {name}"))
    points(axes)
    names = [one.name for one in axes if one.name not in (MACHINE, BITS)]
    texts = {one.name: one.texts[0] for one in axes if one.name in names}
    for machine in machines.values:
        known = figure.method(machine)
        with refusals():
            parsed = {
                name: figure.offer(name, known).parse(text, f"{figure.id}'s {name}")
                for name, text in (asked.settings | texts).items()
            }
            figure.accepted(known, parsed)
    varied = (text for one in axes for text in one.texts if one.values == one.texts)
    files = file_digests([*asked.settings.values(), *varied])
    inputs = whole_inputs(*files) if own_file else inputs_of(FIGURES.module_of(figure.id), ("sweep", *files))
    flags = {"checks": checks, "reference": reference, "picture": pictures}

    def task_of(values, texts):
        changes = {**asked.settings, **{name: texts[name] for name in names}}
        parameters = {
            "figure": asked.what,
            "file": file,
            "machine": values[MACHINE],
            "size": asked.size,
            "bits": values.get(BITS),
            "changes": changes,
            **flags,
        }
        said = f"{figure.id} on {_said({k: t for k, t in texts.items()}).removeprefix('machine=')}"
        return Task(figure_point, parameters, said, inputs)

    return Sweep(f"a sweep of {figure.id}", "figure", figure.id, tuple(axes), task_of, left_out)


def _with_parameters(asked, figure, machines):
    """The machines that have every parameter, and sentences on those of "all" that lack one. Raises Refusal
    where a machine that was named lacks one, or none is left.
    """
    kept, left_out, names = [], [], (*asked.parameters(), *asked.settings)
    for machine in machines.values:
        try:
            for name in names:
                figure.offer(name, figure.method(machine))
        except ValueError as error:
            if machine in asked.machines or len(machines.values) == 1:
                raise Refusal(str(error)) from error
            left_out.append(f"{machine} is left out: {error}")
        else:
            kept.append(machine)
    if not kept:
        raise Refusal(left_out[0].partition(": ")[2])
    return Axis(MACHINE, tuple(kept), tuple(kept)), tuple(left_out)


def _of_study(asked, checks, more):
    study = STUDIES[asked.what]
    if asked.parameters() or asked.settings or asked.size is not None or more:
        raise Refusal(
            f"{study.id} is a study: vary machines and bits alone; it has no parameters, size, reference or "
            "pictures."
        )
    axes: list[Axis] = []
    if study.machines:
        axes.append(asked.machine_axis(study.machines, study.machines[0]))
        axes += asked.bits()
        if checks and (axes[0].values != study.machines[:1] or asked.bits()):
            raise Refusal(
                f"The expected numbers of {study.id} are for {study.machines[0]}; with --check vary nothing."
            )
    elif asked.bits() or set(asked.machines) != {PAPER}:
        raise Refusal(f"{study.id} is measured on no one machine; leave --machines and bits out.")
    inputs = inputs_of(STUDIES.module_of(study.id), ("sweep",))

    def task_of(values, texts):
        parameters = {
            "study": study.id,
            "machine": values.get(MACHINE),
            "bits": values.get(BITS),
            "checks": checks,
        }
        return Task(study_point, parameters, f"{study.id} {_said(texts)}".rstrip(), inputs)

    return Sweep(f"a sweep of {study.id}", "study", study.id, tuple(axes), task_of)


def _of_script(asked, more, pictures):
    path, file = asked.what, _file_of(asked.what)
    script = script_of(path)
    if asked.size is not None or asked.settings or more:
        raise Refusal(
            "--size, --set, --check and --reference are a figure's; a script says its own width, height and "
            "values."
        )
    able = tuple(key for key, profile in PROFILES.items() if not profile.arithmetic.exact)
    own = script.machine if isinstance(script.machine, str) else None
    if own is None:
        own = next((key for key, profile in PROFILES.items() if profile == script.machine), None)
        if own is None:
            raise Refusal(f"{path}: profile is no machine by name; name one, as profile = 'GEFORCE_256'.")
    axes = [asked.machine_axis(able, own)]
    for name, text in asked.varied.items():
        if name == BITS:
            axes += asked.bits()
        else:
            axes.append(axis(name, text, kind_of_texts(text), f"The script's {name}"))
    points(axes)
    names = [one.name for one in axes if one.name not in (MACHINE, BITS)]
    script.check({name: None for name in names})
    inputs = whole_inputs()

    def task_of(values, texts):
        parameters = {
            "script": path,
            "file": file,
            "machine": values[MACHINE],
            "bits": values.get(BITS),
            "values": {name: values[name] for name in names},
            "picture": pictures,
        }
        return Task(script_point, parameters, f"{path} on {_said(texts).removeprefix('machine=')}", inputs)

    return Sweep(f"a sweep of {Path(path).name}", "script", path, tuple(axes), task_of)


@dataclass(eq=False)
class Swept:
    """A sweep that was computed: ``rows()`` has its results, for ``pandas.DataFrame``.

    sweep     the Sweep
    manifest  what is done, by digest
    failed    why others are not, by digest
    """

    sweep: Sweep
    manifest: Manifest
    failed: dict[str, str] = field(default_factory=dict)

    def rows(self, *, times: bool = False) -> list[dict[str, Any]]:
        """A dict for each row, in the grid's order; columns as ``Sweep.rows`` has them."""
        return list(self.sweep.rows(self.manifest, self.failed, times=times))


def sweep(
    what: str,
    varied: Mapping[str, str],
    machines: Sequence[str] = (PAPER,),
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    manifest: str | Path | None = None,
    **more: Any,
) -> Swept:
    """Compute a sweep: a Swept.

    what, varied, machines, more  as ``sweep_of`` takes them, without pictures
    executor                      any ``concurrent.futures.Executor``; None: here, one point after the other
    workers                       how many workers it has, if it does not say so (``of_user``)
    manifest                      the file where finished points are found and stored; None: in memory

    Raises Refusal as ``sweep_of``, ``Manifest`` and ``run`` do.
    """
    asked = sweep_of(what, varied, machines, **more)
    done = Swept(asked, Manifest(manifest, asked.about))
    by = None if executor is None else of_user(executor, workers)
    count = by.workers if by else lambda: 1
    for task, outcome in run(asked.tasks(), by, done.manifest, workers=count):
        if outcome.failed:
            done.failed[task.digest] = f"{task.said}: {outcome.failed}"
    return done
