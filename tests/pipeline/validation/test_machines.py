"""Every feature on every machine: accepted where it is, refused in a sentence where it is not; and the page
that says so.
"""

import re
from pathlib import Path

import pytest

from fixedpipe.pipeline.enums import ColorWeights, CombinerFunction
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.profiles.sections import SECTION_OF, SECTIONS
from fixedpipe.pipeline.validation.validate import validate
from fixedpipe.pipeline.validation.walk import UnsupportedState
from tests.fuzz import Way, differing, outcome
from tests.machines import PAGE, page
from tests.support.features import FEATURES, SIZE
from tests.support.random_frames import random_frame

ROOT = Path(__file__).parents[3]
MACHINES = [profile for profile in PROFILES.values() if not profile.arithmetic.exact]
# What a refusal tells to do: a verb, or what the machine has instead.
HINT = re.compile(
    r"[;.:,] (or )?(add|bias|choose|combine|copy|disable|draw|enable|give|leave|put|read|scale|set|split|use"
    r"|write|it (has|takes|stores) \w)",
    re.IGNORECASE,
)


def ids(value):
    return getattr(value, "name", None)


@pytest.mark.parametrize("feature", FEATURES, ids=ids)
def test_a_feature_is_accepted_exactly_where_the_machine_has_it(feature):
    for profile in PROFILES.values():
        if feature.has(profile):
            validate(feature.commands, profile, SIZE, SIZE, **feature.framebuffer)
            continue
        with pytest.raises(UnsupportedState) as refusal:
            validate(feature.commands, profile, SIZE, SIZE, **feature.framebuffer)
        sentence = str(refusal.value)
        assert profile.name in sentence
        assert re.search(feature.asked, sentence), sentence
        assert HINT.search(sentence), sentence
        assert sentence.endswith(".")


def test_a_machine_of_diamonds_has_no_weights_of_eight_bits():
    with pytest.raises(ValueError, match=r"^NV2A: diamond_exit_lines with .*EIGHT_BITS.* Give color_weights"):
        PROFILES["NV2A"].changed(diamond_exit_lines=True)
    with pytest.raises(ValueError, match="color_weights EIGHT_BITS"):
        PROFILES["OCTANE"].changed(color_weights=ColorWeights.EIGHT_BITS)
    assert PROFILES["NV2A"].changed(diamond_exit_lines=True, color_weights=ColorWeights.EXACT)


def runs_on(feature, profile):
    """Run the feature's commands; the picture."""
    if profile.arithmetic.exact:
        return execute_ideal(feature.commands, SIZE, SIZE).image()
    return execute(feature.commands, profile, SIZE, SIZE, threads=1, **feature.framebuffer).image()


@pytest.mark.parametrize("feature", FEATURES, ids=ids)
def test_a_feature_runs_on_a_machine_that_has_it(feature):
    first = next((p for p in MACHINES if feature.has(p)), None)
    if first is not None:
        runs_on(feature, first)
    if feature.ideal and feature.has(PROFILES["IDEAL"]):
        runs_on(feature, PROFILES["IDEAL"])


@pytest.mark.slow
@pytest.mark.parametrize("feature", FEATURES, ids=ids)
def test_a_feature_runs_on_every_machine_that_has_it(feature):
    for profile in MACHINES:
        if feature.has(profile):
            runs_on(feature, profile)


# The specification of whole frames has bytes: machines of other widths take part with the width of bytes, and
# the future board's own arithmetic has tests of its own.
OF_BYTES = {
    name: profile.with_precision(combiner_bits=8, texture_bits=8, framebuffer_bits=8)
    for name, profile in PROFILES.items()
    if not profile.arithmetic.exact and CombinerFunction.DIVIDE not in profile.combiners.combiner_functions
}


def assert_equal_to_the_specification(profile, seeds):
    for seed in seeds:
        frame = random_frame(seed, profile=profile, depth_bits=profile.widest_depth, size=(16, 12))
        assert not differing(outcome(frame, Way()), outcome(frame, Way(reference=True))), seed


@pytest.mark.parametrize("name", OF_BYTES)
def test_every_machine_equals_the_specification(name):
    assert_equal_to_the_specification(OF_BYTES[name], range(4))


@pytest.mark.slow
@pytest.mark.parametrize("name", OF_BYTES)
def test_every_machine_equals_the_specification_in_many_frames(name):
    assert_equal_to_the_specification(OF_BYTES[name], range(4, 150))


def test_every_feature_is_had_by_some_machine_and_named_once():
    assert len({feature.name for feature in FEATURES}) == len(FEATURES)
    for feature in FEATURES:
        assert any(feature.has(profile) for profile in PROFILES.values()), feature.name


def test_the_page_of_machines_is_as_the_profiles_are():
    assert PAGE.read_text() == page(), "docs/machines.md is stale: make machines"


@pytest.mark.parametrize("feature", FEATURES, ids=ids)
def test_a_features_modules_exist(feature):
    for path in (*feature.reference, *feature.implementation, *feature.tests):
        assert (ROOT / path).is_file(), path
    assert feature.implementation and feature.tests


class Asked:
    """A profile, or a section of one, that remembers which of its fields were asked for."""

    def __init__(self, of, fields):
        self._of, self.fields = of, fields

    def __getattr__(self, name):
        value = getattr(self._of, name)
        if name in SECTIONS:
            return Asked(value, self.fields)
        self.fields.add(name)
        return value


# Fields that say how a machine computes, or how large something may be that every machine has.
WITHOUT_A_FEATURE = {
    "max_viewport",
    "max_pixel_map_table",
    "max_shininess",
    "stencil_bits",
    "blend_factors_destination",
    "depth_units_in_coordinates",
    "hilo_as_color",
    "border_color_as_given",
    "offset_scale_clamped",
    "shades_samples",
}


def test_every_limit_set_and_switch_of_a_profile_decides_about_a_feature():
    asked = set()
    for feature in FEATURES:
        for profile in PROFILES.values():
            observer = Asked(profile, set())
            if feature.has(observer) and feature.limit is not None:
                feature.limit(observer)
            asked |= observer.fields
    capabilities = {name for name, section in SECTION_OF.items() if section != "arithmetic"}
    assert capabilities - asked == WITHOUT_A_FEATURE
