"""One figure on its machines: its pictures, and its record, which is the content of its JSON file."""

import hashlib
import re
import shlex
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, field

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.must_see import is_named
from fixedpipe.effects.bibliography import citation
from fixedpipe.effects.computed_once import kept_array
from fixedpipe.effects.figures import FIGURES, Figure, Method, Renderer
from fixedpipe.effects.presentation.animations import ANIMATIONS
from fixedpipe.effects.refusal import Refusal, refusals
from fixedpipe.effects.reports.figure_failures import failure
from fixedpipe.effects.reports.figure_inputs import said_of
from fixedpipe.effects.reports.figure_passes import Passes
from fixedpipe.effects.reports.letters import labels_of, without_letters
from fixedpipe.effects.reports.motion import in_motion
from fixedpipe.effects.reports.perceived import flip
from fixedpipe.effects.reports.pictures import LOSSLESS, NARROW, OF_GRID, WIDE, Pictures
from fixedpipe.effects.technique import OWN, PAPERS
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.framebuffers.pictures import deep_picture, to_codes
from fixedpipe.pipeline.golden.digests import digest
from fixedpipe.pipeline.golden.provenance import provenance
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import PROFILES

# What each picture is, in the words of its caption.
CAPTIONS = {
    "machine": "{profile}, {method}, bit for bit",
    "ideal": "the same fragments in float64",
    "reference": "what it approximates, without the algorithm",
}
IDENTICAL = "identical: no code of the machine differs from the {of}'s, rounded"
DIFFERS = "(machine - {of}) x {gain} about middle grey"
OF_THE_IDEAL = "{profile}, {method}: float64, rounded to bytes at the end"
# A finer picture's byte where the code is the shown byte, scaled to the code's bits.
FINER_ZERO = 128


@dataclass(frozen=True)
class Rendered:
    """A figure that was drawn.

    record    the content of its JSON file
    pictures  Pictures that the record names by digest
    named     the same and the differences under readable names, F004-4-OCTANE.png, as ``png`` takes them;
              none where they were not asked for
    """

    record: dict
    pictures: Pictures
    named: Mapping[str, np.ndarray]


def variant_name(figure, changes):
    """A figure's name with other values of parameters: F004-4+alpha_x=0.15+light=1,1,1; its id if nothing is
    changed. The names of its files begin with it. So a long or odd name is shortened to its beginning, with _
    for odd characters, followed by a digest of the whole.
    """
    if not changes:
        return figure.id
    said = "+".join(f"{name}={text}" for name, text in _texts(figure, changes).items())
    plain = re.sub(r"[^\w.,=+-]+", "_", said)
    if plain != said or len(said) > 100:
        plain = f"{plain[:80]}-{hashlib.sha256(said.encode()).hexdigest()[:8]}"
    return f"{figure.id}+{plain}"


_PLAIN = (bool, int, float, str, tuple)


def _known(figure):
    """What may be changed in any of a figure's ways, by name."""
    return {name: p for method in figure.methods for name, p in figure.parameters_of(method).items()}


def _texts(figure, changes):
    """Changed values as the command line takes them, by name."""
    known = _known(figure)
    return {name: known[name].kind.show(value) for name, value in changes.items()}


def plain_values(figure, values):
    """Values for JSON, by name: numbers as numbers; values without a form in JSON, such as a height field or
    an enum's member, as the command line takes them.
    """
    known = _known(figure)
    return {n: v if v is None or isinstance(v, _PLAIN) else known[n].kind.show(v) for n, v in values.items()}


def picture_name(name, machine, view):
    """The readable file name of a picture: F004-4-OCTANE.png, F004-4-OCTANE-reference-difference.png ..."""
    return f"{name}-{machine}{'' if view == 'machine' else f'-{view}'.replace('_', '-')}.png"


def steps(figure, machines, with_checks=False, with_references=True):
    """How many steps ``render`` takes for these machines, plus one for writing the result."""
    methods = {figure.method(machine) for machine in machines}
    on_machines = sum(2 + with_checks - PROFILES[m].arithmetic.exact for m in machines)
    on_machines += with_references and figure.id in ANIMATIONS
    return on_machines + len(methods) * (with_references and figure.reference is not None) + 1


def render(
    figure,
    machines,
    size,
    threads,
    with_checks,
    step,
    changes=None,
    file=None,
    *,
    with_references=True,
    with_names=False,
):
    """Render a figure.

    Parameters
    ----------
    figure : fixedpipe.effects.figures.Figure
    machines : tuple of str
        Keys in ``fixedpipe.pipeline.profiles.PROFILES``, of those that can draw it.
    size : int or None
        Edge of a panel in pixels; None: the figure's own.
    threads : int or None
    with_checks : bool
        Run the acceptance checks as well.
    step
        Called with a line of text at the beginning of each step.
    changes : dict, optional
        Other values of parameters, by name: a variant, whose files and record have a name of their own and
        say what was changed. Its acceptance is nobody's: checks hold for the figure's own values.
    file : str, optional
        The user's file that holds the figure; None for the package's.
    with_references : bool
        Compute the figure's references, compare the machines with them, and measure FLIP.
    with_names : bool
        Keep the pictures under readable names as well.

    If drawing or checking fails on one machine, for whatever reason, the record's ``failures`` say so; the
    other machines are drawn all the same.
    """
    size = size or figure.size
    changes = changes or {}
    how = size, threads, changes, step, with_references, with_names
    drawing = _Drawing(figure, variant_name(figure, changes), *how)
    drawn, failures, windows, before = [], [], {}, None
    for machine in machines:
        if (method := figure.method(machine)) is not before:
            windows, before = {}, method  # the ideal's, which machines that draw so share
        try:
            record = drawing.on(machine)
        except Exception as error:
            failures.append(failure(error, machine, file=file))
            continue
        if with_checks:
            step(f"{figure.id}: acceptance checks on the {PROFILES[machine].name}")
            checked = {m["method"] for m in drawn}
            try:
                renderer = Renderer(PROFILES[machine], method, execute, execute_ideal, windows)
                checks = figure.checks(renderer)
            except Exception as error:
                failures.append(failure(error, machine, "checked", file))
                checks = ()
            record["checks"] = [
                c.record() | _shows(figure, c)
                for c in checks
                if c.on is Answer.MACHINE or method.name not in checked
            ]
        drawn.append(record)
    record = record_of(figure, machines, size, changes, with_checks, drawn, failures, file)
    if with_references and drawn and not changes and figure.id in ANIMATIONS:
        step(f"{figure.id}: in motion")
        with suppress(Refusal):
            data, record["animation"] = in_motion(figure, drawn[0]["profile"], size, threads)
            drawing.pictures.whole[f"{record['animation']['digest']}.webp"] = data
    return Rendered(record, drawing.pictures, drawing.named)


def record_of(figure, machines, size, changes, with_checks, drawn, failures, file=None):
    """The record of a figure.

    ``drawn``: a record for each machine that drew it. ``failures``: a ``figure_failures.failure`` for each
    that did not. Other arguments are those of ``render``; ``size`` is a number.
    """
    width, height = figure.dimensions(size)
    across = figure.panel_width(size)
    record = {
        "id": variant_name(figure, changes),
        "title": figure.title,
        "caption": figure.caption_with(bool(changes)),
        "must_see": figure.must_see,
        "source": figure.source,
        "citation": _citation(figure),
        "page": _page(figure),
        "techniques": list(figure.techniques),
        "command": _command(figure, machines, size, changes, with_checks, file),
        "parameters": plain_values(figure, figure.values),
        "size": size,
        "width": width,
        "height": height,
        "panels": [
            {"x": n * across, "y": 0, "width": across, "height": size, "label": label}
            for n, label in enumerate(figure.panels)
        ],
        "machines": drawn,
        "failures": failures,
    }
    if file is not None:
        record["file"] = file
    if changes:
        # What must be seen is of the figure's own values.
        del record["must_see"]
        record |= {"figure": figure.id, "set": plain_values(figure, changes)}
    return record


def _shows(figure, check):
    """The numbers, from 1, of the must-see's sentences that name a Check."""
    numbers = [
        number
        for number, names in enumerate(figure.shown_by, 1)
        if any(is_named(check.name, name) for name in names)
    ]
    return {"must_see": numbers} if numbers else {}


def _citation(figure):
    """The figure's paper; the key alone where the bibliography has no entry yet."""
    try:
        return asdict(citation(figure.source))
    except KeyError:
        return {"authors": "", "title": "", "year": "", "key": figure.source, "bibtex": ""}


def _page(figure):
    """Where the project's documents have the figure; None for an effect of no paper, and a user's figure."""
    if figure.id not in FIGURES or figure.id[0] == OWN:
        return None
    number = figure.id[1:4] if "-" in figure.id else PAPERS[figure.id[0]][0]
    return f"docs/papers/catalogue/{number}.md#{figure.id.lower()}"


def _command(figure, machines, size, changes, with_checks, file):
    """What draws these pictures again."""
    words = ["fixedpipe", "figures", file or figure.id, *["--check"] * with_checks]
    if tuple(machines) != figure.machines:
        words += [word for machine in machines for word in ("--profile", machine)]
    if size != figure.size:
        words += ["--size", str(size)]
    for name, text in _texts(figure, changes).items():
        words += ["--set", f"{name}={text}"]
    return shlex.join(words)


@dataclass
class _Drawing:
    """A figure while it is drawn on one machine after the other: its pictures, and what machines share."""

    figure: Figure
    name: str
    size: int
    threads: int | None
    changes: Mapping[str, object]
    step: Callable[[str], None]
    with_references: bool
    with_names: bool
    pictures: Pictures = field(default_factory=Pictures)
    named: dict[str, np.ndarray] = field(default_factory=dict)
    methods: set[Method] = field(default_factory=set)  # that machines have drawn by
    reference: tuple[Method, np.ndarray | None] | None = None  # of the method that drew last
    kept: list[dict] = field(default_factory=list)  # what the record says of machines' and ideals' pictures
    machines: dict[tuple, str] = field(default_factory=dict)  # the first with these bits, by their digest

    def on(self, machine):
        """What the record says of a machine; its pictures are kept."""
        profile, method = PROFILES[machine], self.figure.method(machine)
        is_first, is_exact = method not in self.methods, profile.arithmetic.exact
        drawn, passes, number = self._drawn(machine, is_first and not is_exact)
        reference = self._reference(method)
        pictures, differences = {"machine": (drawn.image(), drawn.codes())}, {}
        if not is_exact:
            pictures["ideal"] = drawn.ideal.image(), drawn.ideal.codes(drawn.bits)
            differences["difference"] = drawn.difference
        if reference is not None:
            pictures["reference"] = (_codes_of(reference, 8),) * 2
            differences["reference_difference"] = drawn.compared_with(reference)
        shown = {}
        for view, (image, codes) in pictures.items():
            image = image if view == "reference" else image[..., :3]
            reduced = [WIDE if view == "machine" else NARROW] * is_first
            of_grid = [OF_GRID] * (view == "machine" and not self.machines)
            bits = 8 if view == "reference" else drawn.bits
            files = *reduced, *of_grid
            told = self._told(view, image, codes, bits, files, shown, pictures["machine"][1])
            shown[view] = told or self._picture(image, codes, bits, (LOSSLESS, *files), shown.values())
            if self.with_names:
                self.named[picture_name(self.name, machine, view)] = deep_picture(codes, bits)
        # FLIP takes as long as a quarter of all first pictures: it comes with the references.
        with_flip = is_first and self.with_references
        as_bytes = {view: image for view, (image, _) in pictures.items()} if with_flip else {}
        for view, found in differences.items():
            shown[view] = {}
            if not found.identical:
                if self.with_names:
                    self.named[picture_name(self.name, machine, view)] = found.image()
                if is_first:
                    shown[view]["digest"] = self.pictures.add(found.image(), NARROW)
        for view, said in shown.items():
            said["caption"] = self._caption(view, drawn, differences.get(view))
        self.kept += [
            said for view, said in shown.items() if view in ("machine", "ideal") and "delta" not in said
        ]
        codes = hashlib.sha256(np.ascontiguousarray(drawn.codes()[..., :3])).digest()
        same = self.machines.setdefault((drawn.bits, codes), machine)
        record = {
            "profile": machine,
            "name": profile.name,
            "method": method.name,
            "parameters": plain_values(self.figure, _own_values(method)),
            "bits": drawn.bits,
            "sha256": digest(drawn.image()),
            "same_bits_as": None if same == machine else same,
            "difference": None,
            **{view: _measures(found, as_bytes) for view, found in differences.items()},
            "pictures": shown,
            "checks": [],
            "provenance": provenance(profile),
        }
        if labels := [] if self.with_names else self._labels(machine):
            record["labels"] = labels
        if is_first:
            record["passes"] = [self._pass(one) for one in passes]
            record["commands"] = number
        return record

    def _drawn(self, machine, with_passes):
        """The Rendering, with its ideal, the Passes where they are asked for, and the number of commands."""
        profile, (width, height) = PROFILES[machine], self.figure.dimensions(self.size)
        where = "by the ideal" if profile.arithmetic.exact else f"on the {profile.name}"
        self.step(f"{self.name}: {where}, {width}x{height}")
        seen = []

        def watch(commands):
            seen.append(Passes(commands, (height, width)))
            return seen[0]

        with refusals():
            given = {"threads": self.threads, "watch": watch if with_passes else None}
            if not self.with_names:  # the page sets the letters; files under names have the machine's
                given["method"] = without_letters(self.figure.method(machine))
            drawn = self.figure.render(machine, self.size, **given, **self.changes)
            if not profile.arithmetic.exact:
                self.step(f"{self.name}: the same on the ideal")
                _ = drawn.ideal
        if not seen:
            return drawn, [], 0
        return drawn, seen[0].passes(drawn.image()), len(seen[0].lines)

    def _labels(self, machine):
        """The figure's letters as text, where the page sets them."""
        with refusals():
            commands = self.figure.commands(machine, self.size, **self.changes)
        return labels_of(commands, self.figure.dimensions(self.size)[1])

    def _reference(self, method):
        """The figure's reference with a method's values, kept until another method draws."""
        if self.reference is None or self.reference[0] is not method:
            self.methods.add(method)
            self.reference = method, None
            if self.with_references and self.figure.reference is not None:
                self.step(f"{self.name}: the reference")
                with refusals():
                    self.reference = method, self._computed_reference(method)
        return self.reference[1]

    def _computed_reference(self, method):
        """The reference; where it follows from the package's sources alone, it is kept for other runs."""
        if self.changes or self.figure.id not in FIGURES or FIGURES[self.figure.id] is not self.figure:
            return self.figure.reference_picture(self.size, method, **self.changes)
        module = FIGURES.module_of(self.figure.id)
        key = "reference", self.figure.id, method.name, self.size, said_of(module)
        return kept_array(key, (module,), self.figure.reference_picture, self.size, method)

    def _told(self, view, image, codes, bits, files, shown, machine):
        """What the record says of an ideal of more than 8 bits: how far its codes are from the ``machine``'s,
        in one picture; None where that is no picture of bytes.
        """
        if view != "ideal" or bits == 8:
            return None
        delta = codes[..., :3].astype(np.int32) - machine[..., :3]
        if np.abs(delta).max() >= FINER_ZERO:
            return None
        height, width = image.shape[:2]
        said = {"delta": self.pictures.add((delta + FINER_ZERO).astype(np.uint8), LOSSLESS)}
        said |= {"of": {name: shown["machine"][name] for name in ("digest", "finer")}}
        return {
            **said,
            "digest": self.pictures.add(image, *files),
            "width": width,
            "height": height,
            "bits": bits,
        }

    def _picture(self, image, codes, bits, files, shown):
        """What the record says of a picture that is kept without loss: bytes, and of longer codes what bytes
        leave. Either may be told from a picture that was kept before.

        ``shown``: what the record says of the machine's other pictures.
        """
        earlier, finer = [*shown, *self.kept[:2], *self.kept[-2:]], None
        if bits > 8:
            one = 2**bits - 1
            coarse = (2 * image[..., :3].astype(np.int32) * one + 255) // 510
            left = (codes[..., :3] - coarse + FINER_ZERO).astype(np.uint8)
            finer = self.pictures.add(left, LOSSLESS, bases=[said.get("finer") for said in earlier])
        height, width = image.shape[:2]
        bases = [said.get("digest") for said in earlier]
        kept = {"digest": self.pictures.add(image, *files, bases=bases), "width": width, "height": height}
        return {**kept, "bits": bits, "finer": finer}

    def _caption(self, view, drawn, found):
        """What a picture is, in words. ``found``: the Difference that it shows, if it shows one."""
        names = {"profile": drawn.profile.name, "method": drawn.method.name}
        if found is not None:
            said = IDENTICAL if found.identical else DIFFERS
            words = said.format(of=found.of, gain=found.gain)
        else:
            is_exact = drawn.profile.arithmetic.exact
            words = (OF_THE_IDEAL if is_exact and view == "machine" else CAPTIONS[view]).format(**names)
        return words + "".join(
            f"; {name} = {text}" for name, text in _texts(self.figure, self.changes).items()
        )

    def _pass(self, seen):
        preview = self.pictures.add(seen.picture[..., :3], NARROW)
        said = {"number": seen.number, "label": seen.label, "commands": list(seen.commands)}
        return {**said, "preview": preview}


def _codes_of(reference, bits):
    """A reference as codes, [h, w, 4]; alpha is all or nothing, and bytes are uint8."""
    codes = to_codes(reference, bits)
    codes[..., 3] = np.where(reference[..., 3] > 0.0, 2**bits - 1, 0)
    return codes.astype(np.uint8) if bits == 8 else codes


def _measures(found, as_bytes):
    """A Difference in numbers. ``as_bytes``: pictures by view, for FLIP; empty: without it."""
    measured = {
        "identical": found.identical,
        "gain": found.gain,
        "rms": found.rms,
        "max": found.largest,
        "at": found.at and list(found.at),
        "pixels": found.pixels,
    }
    seen = flip(as_bytes["machine"], as_bytes[found.of]) if as_bytes else None
    return measured if seen is None else {**measured, "flip": seen}


def _own_values(method):
    """What of the parameters' values is the method's, by name."""
    return {**method.values, **{name: p.default for name, p in method.parameters.items()}}
