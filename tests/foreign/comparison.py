"""A case of another suite, drawn by a machine or by the ideal, and compared with what that suite expects."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import pytest

from fixedpipe.pipeline import PROFILES, execute, execute_ideal
from fixedpipe.pipeline.execution.machine import Engine
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState

MACHINES = (
    "OPENGL_1_2",
    "MULTITEXTURE",
    "G400",
    "GEFORCE_256",
    "GEFORCE_3",
    "NV2A",
    "OCTANE",
    "INFINITE_REALITY",
    "IDEAL",
)
# The machines of the makers whose drivers ran a test: of NVIDIA's register combiners, of its texture shader.
WITH_COMBINERS = ("GEFORCE_256", "GEFORCE_3", "NV2A", "IDEAL")
WITH_TEXTURE_SHADER = ("G400", "GEFORCE_3", "NV2A", "IDEAL")


@dataclass(frozen=True, eq=False)
class Case:
    """What one comparison of a test draws, in a window of ``size``, and what is ``expected`` of the picture.

    ``expected`` takes the components of a picture, float64 [h, w, 4], 255.0 is one, top row first, and says
    what differs. ``machines``: those whose kind the test was written for.
    """

    name: str
    frame: tuple
    expected: Callable[[np.ndarray], list[str]]
    size: tuple[int, int]
    machines: tuple[str, ...] = MACHINES
    depth_bits: int | None = None


def pixels(wanted: Sequence[tuple], alpha: bool = False) -> Callable[[np.ndarray], list[str]]:
    """Expectation of single pixels: (x, y from the top, 0xRRGGBB, tolerance), the colour with alpha in its
    highest byte where ``alpha``; a tuple of colours: any of them.
    """
    shifts = (16, 8, 0, 24) if alpha else (16, 8, 0)

    def differences(image):
        found = []
        for x, y, colors, tolerance in wanted:
            colors = colors if isinstance(colors, tuple) else (colors,)
            has = image[y, x, : len(shifts)]
            apart = [max(abs(has - [color >> shift & 255 for shift in shifts])) for color in colors]
            if min(apart) > tolerance + 0.5:
                names = " or ".join(f"{color:06x}" for color in colors)
                found.append(f"({x}, {y}) is {has.round(1).tolist()} and not {names}, within {tolerance}")
        return found

    return differences


def picture(wanted: np.ndarray, tolerance: float | np.ndarray) -> Callable[[np.ndarray], list[str]]:
    """Expectation of a whole picture [h, w, 3..4], 1.0 is one; ``tolerance`` is of 255, of all or of each."""

    def differences(image):
        apart = np.abs(image[..., : wanted.shape[-1]] - np.clip(wanted, 0, 1) * 255).max(-1)
        return [
            f"({x}, {y}) is {image[y, x].round(1).tolist()} and not {(wanted[y, x] * 255).round(1).tolist()}"
            for y, x in np.argwhere(apart > tolerance).tolist()
        ]

    return differences


def drawn(case: Case, machine: str, engine: Engine | None = None) -> np.ndarray | None:
    """The picture of a case, [h, w, 4], 255.0 is one; None where the machine refuses it in a sentence.
    ``engine``: as of ``execute``.
    """
    try:
        if machine == "IDEAL":
            return np.clip(execute_ideal(case.frame, *case.size).color, 0, 1) * 255
        result = execute(case.frame, PROFILES[machine], *case.size, depth_bits=case.depth_bits, engine=engine)
    except UnsupportedState:
        return None
    return result.image().astype(float)


def is_held(case: Case, machine: str) -> bool:
    """Whether a machine takes a case's frame; it refuses others in a sentence."""
    try:
        validate(case.frame, PROFILES[machine], *case.size, case.depth_bits)
    except UnsupportedState:
        return False
    return True


def on_machines(
    cases: Sequence[Case], disagreements: Mapping[tuple[str, str], str] = MappingProxyType({})
) -> list:
    """Each case on each of its machines, for ``parametrize``; where ``disagreements`` has its name and the
    machine's, it has to fail. All machines but a case's first, the GeForce 3 and the ideal are of the long
    proofs: most draw the same.
    """
    assert len({case.name for case in cases}) == len(cases)
    params, left = [], set(disagreements)
    for case in cases:
        for machine in case.machines:
            left.discard(key := (case.name, machine))
            reason = disagreements.get(key)
            marks = [] if reason is None else [pytest.mark.xfail(strict=True, reason=reason)]
            if machine not in (case.machines[0], "GEFORCE_3", "IDEAL"):
                marks.append(pytest.mark.slow)
            params.append(pytest.param(case, machine, marks=marks, id=f"{case.name}, {machine}"))
    assert not left, f"no such case or machine: {left}"
    return params


def assert_drawn(case: Case, machine: str, engine: Engine | None = None) -> None:
    """Assert that a machine draws what is expected, or refuses the frame in a sentence."""
    image = drawn(case, machine, engine)
    if image is not None:
        differences = case.expected(image)
        assert not differences, f"{len(differences)} differ: {'; '.join(differences[:6])}"


def assert_held(
    cases: Sequence[Case], refused: int, nowhere: Mapping[str, str] = MappingProxyType({})
) -> None:
    """Assert that some machine draws each case but those ``nowhere`` names, each with its reason, and how
    many frames are ``refused`` in all: a refused frame passes, so that number must not grow unseen. Whoever
    changes it reads the sentences of ``validate``; each has to name what the machine lacks.
    """
    held = {case.name: [is_held(case, machine) for machine in case.machines] for case in cases}
    assert {name for name, answers in held.items() if not any(answers)} == set(nowhere)
    assert sum(answers.count(False) for answers in held.values()) == refused


def everywhere(reason: str, names: Sequence[str], machines: Sequence[str]) -> dict[tuple[str, str], str]:
    """Disagreements of some cases on some machines, for one reason."""
    return {(name, machine): reason for name in names for machine in machines}
