"""The features of a machine and the widths of its numbers.

A machine is one value of ``Profile``. This package has a literal for each machine that is no descendant of
another. Every value stands beside its evidence, in a section by subject
(``fixedpipe.pipeline.profiles.sections``). Code asks what a machine can do, never which machine it is.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from numbers import Integral
from typing import TYPE_CHECKING, Any

from fixedpipe.pipeline.enums import Clamp, ColorWeights
from fixedpipe.pipeline.profiles.known import Known, known
from fixedpipe.pipeline.profiles.sections import (
    SECTION_OF,
    SECTIONS,
    Arithmetic,
    Combiners,
    Fragments,
    Framebuffers,
    Pixels,
    Primitives,
    Textures,
    TextureShaders,
    Vertices,
)

# The compiled kernels' bits of components and of subpixels; only the column engine draws with others.
NATIVE_BITS = 8
NATIVE_SUBPIXEL_BITS = 4


def _refuse_unknown(given):
    if unknown := given.keys() - SECTION_OF.keys():
        near = [field for name in sorted(unknown) for field in get_close_matches(name, SECTION_OF)]
        raise TypeError(
            f"A profile has no field {', '.join(sorted(unknown))}; "
            + (f"the nearest are {', '.join(near)}." if near else "Profile.facts has those that there are.")
        )


@dataclass(frozen=True, kw_only=True)
class Driver:
    """A driver of a machine, by the properties in which the machine with it differs from its profile.

    - ``name``: the name in ``with_driver``, as in "Detonator XP".
    - ``since``: its date, in words.
    - ``facts``: fields of the profile's sections, each as known(value, evidence); empty: nothing differs.
    """

    name: str
    since: str
    facts: Mapping[str, Any]


@dataclass(frozen=True, kw_only=True)
class Profile:
    """A machine as data: what it can do, and how wide its numbers are. Each value has its evidence.

    - ``name``: its name in messages.
    - ``description``: one line.
    - ``ancestor``: the machine that it was made from (``descendant``); None: from none.
    - ``changed_from``: the machine that this one is with other values (``changed``); equal machines may
      differ in it.
    - ``drivers``: its drivers whose dates are known, the oldest first.
    - ``driver``: the name of the driver that it has (``with_driver``); None: none was chosen.

    Raises ValueError for ``diamond_exit_lines`` with ``color_weights`` EIGHT_BITS.
    """

    name: str
    description: str
    textures: Textures
    texture_shaders: TextureShaders
    combiners: Combiners
    vertices: Vertices
    primitives: Primitives
    fragments: Fragments
    framebuffers: Framebuffers
    pixels: Pixels
    arithmetic: Arithmetic
    ancestor: "Profile | None" = None
    changed_from: "Profile | None" = field(default=None, compare=False, repr=False)
    drivers: tuple[Driver, ...] = field(default=(), compare=False, repr=False)
    driver: str | None = None

    def __post_init__(self) -> None:
        # Weights of eight bits were measured between 0 and 1 and clamp nothing. A line of diamonds takes
        # values beyond its ends (docs/numbers.md, sections 4 and 11).
        if self.arithmetic.diamond_exit_lines and self.arithmetic.color_weights == ColorWeights.EIGHT_BITS:
            raise ValueError(
                f"{self.name}: diamond_exit_lines with color_weights EIGHT_BITS; what weights of eight bits "
                f"are beyond a line's ends is not defined. Give color_weights EXACT, or lines by the NV2A's "
                f"steps (diamond_exit_lines False)."
            )

    @classmethod
    def of(cls, facts: Mapping[str, Any], *, name: str, description: str, **own: Any) -> "Profile":
        """A machine of ``facts`` and its ``own``, which come first: fields as known(value, evidence).

        ``facts`` are what holds of any machine, as a specification's words do (``specified.CORE``).

        Raises TypeError for a name that no section has and where a field is missing, ValueError for a value
        without evidence.
        """
        whole = {**facts, **own}
        _refuse_unknown(whole)
        sections: dict[str, Any] = {
            section: kind(**{field: whole[field] for field in kind.names() if field in whole})
            for section, kind in SECTIONS.items()
        }
        return cls(name=name, description=description, **sections)

    if not TYPE_CHECKING:  # to a type checker every name would exist

        def __getattr__(self, name):
            section = SECTION_OF.get(name)
            hint = f"ask {section}.{name}" if section else f"its sections are {', '.join(SECTIONS)}"
            raise AttributeError(f"A profile has no {name}; {hint}.")

    @property
    def widest_depth(self) -> int:
        """The widest fixed format that a depth buffer may have; it is the default."""
        return max(self.framebuffers.depth_bits)

    @property
    def facts(self) -> Mapping[str, Known]:
        """{name: value and evidence} of every field of every section, in order."""
        everything = {}
        for name, section in SECTION_OF.items():
            fields = getattr(self, section)
            everything[name] = Known(getattr(fields, name), fields.evidence[name])
        return everything

    def changed(
        self,
        *,
        evidence: str = "Assumed: nothing; a value that was asked for",
        name: str | None = None,
        **values: Any,
    ) -> "Profile":
        """The same machine with other ``values`` by their fields' names, for a study or a test.

        ``evidence`` is that of each value. ``name`` is the changed machine's; None: this one's.

        Raises TypeError for a name that no section has, and for a value that does not fit its field;
        ValueError for evidence without a tag.
        """
        given = {field: known(value, evidence) for field, value in values.items()}
        return self._with(given, name=self.name if name is None else name, changed_from=self)

    def descendant(
        self, *, name: str, description: str, inherited: str | None = None, **own: Any
    ) -> "Profile":
        """A machine that is made from this one and differs in ``own``: fields as known(value, evidence).

        ``inherited`` is the evidence of every other field. None: this machine's evidence, where it also holds
        for the descendant itself, as a specification's words do.

        Raises TypeError for a name that no section has, ValueError for a value without evidence.
        """
        if inherited is not None:
            own = {field: known(was.value, inherited) for field, was in self.facts.items()} | own
        changes = {"ancestor": self, "changed_from": None, "drivers": (), "driver": None}
        return self._with(own, name=name, description=description, **changes)

    def with_driver(self, name: str) -> "Profile":
        """The machine as it was with one of its ``drivers``.

        It refuses what a later driver brought, in a sentence that names that driver. Raises ValueError for a
        name that no driver has, and where a driver was already chosen.
        """
        if self.driver is not None:
            raise ValueError(
                f"{self.name} has a driver already; take {name!r} from the machine without one, its "
                "changed_from."
            )
        for driver in self.drivers:
            if driver.name == name:
                named = {"name": f"{self.name} with {name}", "driver": name, "changed_from": self}
                return self._with(driver.facts, **named)
        known_names = ", ".join(repr(driver.name) for driver in self.drivers)
        has = f"those known are {known_names}" if self.drivers else "none of its drivers is known"
        raise ValueError(f"{self.name} has no driver {name!r}; {has}.")

    def later_drivers(self) -> "tuple[Profile, ...]":
        """The machine with each driver that came after the one that it has, the oldest first."""
        own = self
        while own.driver is not None and own.changed_from is not None:
            own = own.changed_from
        names = [driver.name for driver in self.drivers]
        first = 0 if self.driver is None else names.index(self.driver) + 1
        return tuple(own.with_driver(name) for name in names[first:])

    def _with(self, given, **changes):
        """The machine with fields as ``given``, each with its evidence, and with other changes."""
        _refuse_unknown(given)
        whole = {**self.facts, **given}
        for section in dict.fromkeys(SECTION_OF[name] for name in given):
            kind = SECTIONS[section]
            changes[section] = kind(**{name: whole[name] for name in kind.names()})
        return replace(self, **changes)

    def with_precision(
        self,
        *,
        combiner_bits: int | None = None,
        texture_bits: int | None = None,
        framebuffer_bits: int | None = None,
        filter_fraction_bits: int | None = None,
        subpixel_bits: int | None = None,
    ) -> "Profile":
        """The same machine with other widths, each of 4 to 16 bits; None: its own.

        - ``combiner_bits``: of a value of one in combiners and texture environments (registers also have a
          sign).
        - ``texture_bits``: of texel components of the machine's widest formats.
        - ``framebuffer_bits``: of a colour buffer's components.
        - ``filter_fraction_bits``: of a linear filter's weights.
        - ``subpixel_bits``: of window coordinates.

        Pbuffers keep their formats. Raises ValueError for a width that is not 4 to 16.
        """
        asked = {
            "combiner_bits": combiner_bits,
            "texture_bits": texture_bits,
            "framebuffer_bits": framebuffer_bits,
            "filter_fraction_bits": filter_fraction_bits,
            "subpixel_bits": subpixel_bits,
        }
        given = {name: bits for name, bits in asked.items() if bits is not None}
        for name, bits in given.items():
            if isinstance(bits, bool) or not isinstance(bits, Integral) or not 4 <= bits <= 16:
                raise ValueError(f"{name} is {bits!r}; a machine's numbers may have 4 to 16 bits.")
        if not given:
            return self
        words = ", ".join(f"{name} {bits}" for name, bits in given.items())
        widths: dict[str, Any] = {name: int(bits) for name, bits in given.items()}
        if "framebuffer_bits" in widths:
            widths["color_bits"] = (widths.pop("framebuffer_bits"),)
        evidence = "Assumed: nothing; a width that was asked for"
        return self.changed(name=f"{self.name} with {words}", evidence=evidence, **widths)

    def without_clamps(self, *clamps: Clamp) -> "Profile":
        """The same machine with these of its clamps (``fixedpipe.pipeline.enums.Clamp``) switched off.

        Raises ValueError for a value that is no Clamp.
        """
        for clamp in clamps:
            if not isinstance(clamp, Clamp):
                raise ValueError(
                    f"{clamp!r} is no clamp; give members of Clamp: {', '.join(Clamp.__members__)}."
                )
        if not clamps:
            return self
        words = ", ".join(clamp.name for clamp in clamps)
        return self.changed(
            name=f"{self.name} without clamps {words}",
            evidence="Assumed: nothing; clamps that were asked to be off",
            clamps=self.arithmetic.clamps - set(clamps),
        )
