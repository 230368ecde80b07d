"""Machines as data: every value has its evidence, and no machine carries another's by accident."""

import copy
import pickle
import re
from dataclasses import fields, replace
from itertools import combinations

import pytest

from fixedpipe.pipeline.enums import Clamp, CombinerFunction, TextureCompareMode, WrapMode
from fixedpipe.pipeline.profiles import PROFILES, specified
from fixedpipe.pipeline.profiles.known import EVIDENCE_TAGS, known
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.profiles.sections import SECTION_OF, SECTIONS, Framebuffers, Vertices

GEFORCE_256, NV2A = PROFILES["GEFORCE_256"], PROFILES["NV2A"]
KEYS = {id(profile): key for key, profile in PROFILES.items()}

# What evidence calls each machine. Captures, the tests that drew them and the registers are the NV2A's.
NAMES = {
    "OPENGL_1_2": "plain board",
    "OPENGL_1_2_IMAGING": "imaging board",
    "MULTITEXTURE": "TNT",
    "GEFORCE_256": "GeForce 256|NV10",
    "GEFORCE_3": "GeForce 3|NV20",
    "NV2A": r"NV2A|nxdk_pgraph_tests|nv_objects\.h|SET_[A-Z]|captures|(?<!a )capture",
    "OCTANE": "Octane|Impact",
    "INFINITE_REALITY": "InfiniteReality|RealityEngine|Montrym",
    "G400": "G400|Matrox",
    "TEXRAM": "TEXRAM|Schilling",
    "SCHILLING": "Schilling board",
    "FUTURE": "future board",
    "IDEAL": "ideal machine",
}
# How evidence names another machine on purpose: as what it is drawn from, or as what a source speaks of.
ON_PURPOSE = (
    r"\b(from|as on|as wide as|introduced with|for|models) the ({names})\b|({names}) and later"
    r"|on ({names})s alone|but ({names})"
)
# Words of a specification or a paper hold of every machine that they are about.
SPECIFIED = re.compile(
    r"Source: (OpenGL 1\.2\.1|no OpenGL extension|(ARB|ATI|EXT|NV|SGIS|SGIX|WGL)_\w+"
    r"|[A-Z][\w, ]* \d{4}, section)"
)
# What evidence says of a value: that there is none of it, a number, the other machine that has it, and what
# OpenGL 1.2.1 gives (tables 6.24 and 2.7).
LACKS = re.compile(
    r"Assumed: none|no part of it$|\(asked for, so not there\)|subset alone$|no OpenGL extension has it"
)
NUMBER = re.compile(r"Assumed: (?:-?\d+ to )?(-?\d+)")
AS_ON = r"(Inferred: from|as on|as wide as) the ({names})"
OPENGL = {
    "(the minimum)": {"max_lights": 8, "max_clip_planes": 6, "subpixel_bits": 4},
    "table 2.7": {"max_shininess": 128},
}
# Some of what the other machine has: fixed formats of depth, and Schilling's offsets.
SOME = {("GEFORCE_256", "depth_bits"), ("TEXRAM", "texture_shader_operations")}
YEAR = re.compile(r"\b(?:199|200)\d\b")


def line_of(key):
    """A machine and all that it was made from, by their keys."""
    profile, line = PROFILES[key], set()
    while profile is not None:
        line.add(KEYS[id(profile)])
        profile = profile.ancestor
    return line


def facts():
    """(machine's key, field, evidence) of every field of every machine."""
    return [(key, field, fact.evidence) for key, p in PROFILES.items() for field, fact in p.facts.items()]


def test_every_value_says_how_it_is_known():
    for key, field, evidence in facts():
        tag, _, what = evidence.partition(" ")
        assert tag in EVIDENCE_TAGS, f"{key}.{field}"
        assert len(what) > 8, f"{key}.{field}: the tag needs a reason"


def test_two_machines_share_a_sentence_only_by_descent_or_from_a_specification():
    said = {key: {} for key in PROFILES}
    for key, field, evidence in facts():
        said[key].setdefault(evidence, field)
    for one, other in combinations(PROFILES, 2):
        if one in line_of(other) or other in line_of(one):
            continue
        for evidence in said[one].keys() & said[other].keys():
            where = f"{one}.{said[one][evidence]} and {other}.{said[other][evidence]}: {evidence}"
            assert SPECIFIED.match(evidence) and "Assumed" not in evidence, where


def test_evidence_that_names_another_machine_says_what_it_has_of_it():
    for key, field, evidence in facts():
        for other, names in NAMES.items():
            if other not in line_of(key) and re.search(rf"\b({names})", evidence):
                assert re.search(ON_PURPOSE.format(names=names), evidence), f"{key}.{field}: {evidence}"


def test_measurements_are_of_the_machine_itself():
    assert {key for key, _, evidence in facts() if evidence.startswith("Measured:")} == {"NV2A"}


def test_evidence_is_no_older_than_its_machine():
    """A paper cannot say what a later chip lacks, nor a driver of another year what this one's did."""
    for key, field, evidence in facts():
        built = YEAR.search(PROFILES[key].description)
        for year in YEAR.findall(evidence):
            assert built is None or year >= built[0], f"{key}.{field}: {evidence}"
        for year in re.findall(r"(?:driver|board|query) of (\d{4})", evidence):
            assert built is not None and year == built[0], f"{key}.{field}: {evidence}"


def elements(value):
    """A set's or tuple's elements, or a value by itself."""
    return value if isinstance(value, frozenset | tuple) else (value,)


def test_a_value_is_nothing_where_its_evidence_says_that_there_is_none():
    for key, profile in PROFILES.items():
        for field, fact in profile.facts.items():
            if LACKS.search(fact.evidence):
                nothing = (False, 0, TextureCompareMode.NONE, CombinerFunction.NONE)
                nothing += (1,) if field in ("max_anisotropy", "max_probes", "samples") else ()
                assert all(each in nothing for each in elements(fact.value)), f"{key}.{field}: {fact}"


def test_a_value_is_the_number_that_its_evidence_gives():
    for key, profile in PROFILES.items():
        for field, (value, evidence) in profile.facts.items():
            if number := NUMBER.match(evidence):
                assert int(number[1]) in elements(value), f"{key}.{field}: {value}, {evidence}"
            for words, given in OPENGL.items():
                if words in evidence:
                    assert value == given[field], f"{key}.{field}: {value}, {evidence}"


def test_a_value_is_the_machine_s_that_its_evidence_has_it_from():
    for key, profile in PROFILES.items():
        for field, (value, evidence) in profile.facts.items():
            for other, names in NAMES.items():
                if re.search(AS_ON.format(names=names), evidence):
                    theirs = PROFILES[other].facts[field].value
                    some = (key, field) in SOME and set(value) < set(theirs)
                    assert value == theirs or some, f"{key}.{field}: {value}, {other} {theirs}, {evidence}"


def test_a_section_has_values_and_how_they_are_known():
    assert NV2A.vertices.max_lights == 8
    assert NV2A.vertices.evidence["max_lights"] == NV2A.facts["max_lights"].evidence
    assert NV2A.facts["max_lights"].value == 8
    assert list(NV2A.facts) == list(SECTION_OF)


TABLES = {  # of OpenGL 1.2.1
    "CORE_SOURCE_FACTORS": "ZERO ONE DST_COLOR ONE_MINUS_DST_COLOR SRC_ALPHA ONE_MINUS_SRC_ALPHA DST_ALPHA "
    "ONE_MINUS_DST_ALPHA SRC_ALPHA_SATURATE",  # 4.1
    "CORE_DESTINATION_FACTORS": "ZERO ONE SRC_COLOR ONE_MINUS_SRC_COLOR SRC_ALPHA ONE_MINUS_SRC_ALPHA "
    "DST_ALPHA ONE_MINUS_DST_ALPHA",  # 4.2
    "CONSTANT_FACTORS": "CONSTANT_COLOR ONE_MINUS_CONSTANT_COLOR CONSTANT_ALPHA ONE_MINUS_CONSTANT_ALPHA",
    "SUBSET_EQUATIONS": "FUNC_ADD FUNC_SUBTRACT FUNC_REVERSE_SUBTRACT MIN MAX",  # section 4.1.6
    "CORE_STENCIL_OPERATIONS": "KEEP ZERO REPLACE INCR DECR INVERT",  # section 4.1.4
    "CORE_WRAP_MODES": "REPEAT CLAMP CLAMP_TO_EDGE",  # section 3.8.4
    "CORE_TEXGEN_MODES": "NONE OBJECT_LINEAR EYE_LINEAR SPHERE_MAP",  # section 2.10.4
    "CORE_ENVIRONMENTS": "MODULATE REPLACE DECAL BLEND",  # section 3.8.9
    "CORE_TARGETS": "TEXTURE_1D TEXTURE_2D TEXTURE_3D",  # section 3.8
}


@pytest.mark.parametrize("name", TABLES)
def test_sets_that_machines_share_are_the_specification_s(name):
    assert {member.name for member in getattr(specified, name)} == set(TABLES[name].split())


def test_what_holds_of_any_machine_is_the_specification_s_word():
    for field, fact in (specified.CORE | specified.SUBSET).items():
        assert SPECIFIED.match(fact.evidence), f"{field}: {fact.evidence}"
        assert "Assumed" not in fact.evidence, field


def test_a_machine_of_facts_needs_every_field_and_no_other():
    whole = NV2A.facts
    made = Profile.of(whole, name="n", description="d", max_lights=known(4, "Assumed: for this test"))
    assert (made.name, made.description, made.ancestor, made.vertices.max_lights) == ("n", "d", None, 4)
    assert {**made.facts, "max_lights": whole["max_lights"]} == whole
    with pytest.raises(TypeError, match="no field max_light; the nearest are max_lights"):
        Profile.of(whole, name="n", description="d", max_light=known(4, "Assumed: for this test"))
    with pytest.raises(TypeError, match="max_lights"):
        Profile.of({k: v for k, v in whole.items() if k != "max_lights"}, name="n", description="d")
    with pytest.raises(ValueError, match="without evidence"):
        Profile.of(whole, name="n", description="d", max_lights=4)


def test_sections_are_the_profiles_and_no_two_have_a_field_of_one_name():
    assert [f.name for f in fields(Profile)][2:-4] == list(SECTIONS)
    assert len(SECTION_OF) == sum(len(kind.names()) for kind in SECTIONS.values())


def test_a_value_without_evidence_is_refused():
    given = {name: known(NV2A.facts[name].value, "Assumed: for this test") for name in Vertices.names()}
    assert Vertices(**given).max_lights == 8
    with pytest.raises(ValueError, match=r"Vertices.max_lights is 8, without evidence; give known"):
        Vertices(**{**given, "max_lights": 8})
    with pytest.raises(ValueError, match="without evidence"):
        replace(NV2A.vertices, max_lights=known(4, "Assumed: for this test"))
    with pytest.raises(ValueError, match="begin it with one of Source:"):
        known(8, "I think so")
    with pytest.raises(ValueError, match="begin it with one of Source:"):
        known(8, 8)
    with pytest.raises(ValueError, match=r"Framebuffers.color_bits is \(8,\), without evidence"):
        Framebuffers(**{name: NV2A.facts[name] for name in Framebuffers.names()} | {"color_bits": (8,)})
    with pytest.raises(TypeError, match="max_lights"):
        Vertices(**{name: given[name] for name in given if name != "max_lights"})


def test_a_changed_machine_does_not_keep_what_was_said_of_the_value():
    changed = NV2A.changed(max_lights=4, subpixel_bits=5)
    assert (changed.vertices.max_lights, changed.arithmetic.subpixel_bits) == (4, 5)
    assert changed.name == NV2A.name and changed.ancestor is None
    for field, fact in changed.facts.items():
        if field in ("max_lights", "subpixel_bits"):
            assert fact.evidence == "Assumed: nothing; a value that was asked for"
        else:
            assert fact == NV2A.facts[field]
    named = NV2A.changed(max_lights=4, name="half an NV2A", evidence="Assumed: half as many")
    assert (named.name, named.facts["max_lights"].evidence) == ("half an NV2A", "Assumed: half as many")
    assert NV2A.vertices.max_lights == 8
    with pytest.raises(TypeError, match="no field max_lightz; the nearest are max_lights"):
        NV2A.changed(max_lightz=4)
    with pytest.raises(TypeError, match=r"no field qqq; Profile\.facts has those that there are"):
        NV2A.changed(qqq=4)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"max_lights": "many"}, r"Vertices.max_lights is 'many'; its type is int"),
        ({"max_lights": None}, r"max_lights is None; its type is int"),
        ({"max_lights": True}, r"max_lights is True; its type is int"),
        ({"fog_coordinate": 1}, r"fog_coordinate is 1; its type is bool"),
        ({"max_lod_bias": "4"}, r"max_lod_bias is '4'; its type is float"),
        ({"wrap_modes": WrapMode.REPEAT}, r"wrap_modes is .*REPEAT.*; its type is frozenset of WrapMode"),
        ({"wrap_modes": frozenset({"REPEAT"})}, r"its type is frozenset of WrapMode"),
        ({"depth_bits": (16.0,)}, r"its type is tuple of DepthFormat or int"),
        ({"max_lights": known(4, "Assumed: x")}, r"max_lights is Known\(.*; its type is int"),
    ],
)
def test_a_value_of_another_type_is_refused(values, words):
    with pytest.raises(TypeError, match=words):
        NV2A.changed(**values)


def test_who_asks_for_what_is_elsewhere_is_told_where():
    with pytest.raises(AttributeError, match=r"A profile has no max_lights; ask vertices.max_lights\."):
        NV2A.max_lights  # noqa: B018 (asking is what is tested)
    with pytest.raises(AttributeError, match="no lamps; its sections are textures, texture_shaders, comb"):
        NV2A.lamps  # noqa: B018
    with pytest.raises(AttributeError, match="Vertices has no lamps; its fields are max_lights, max_clip"):
        NV2A.vertices.lamps  # noqa: B018


@pytest.mark.parametrize("bits", [3, 17, 8.0, True, "8"])
def test_a_width_that_no_machine_has_is_refused(bits):
    with pytest.raises(ValueError, match=f"texture_bits is {bits!r}; .* may have 4 to 16 bits"):
        NV2A.with_precision(texture_bits=bits)


def test_the_widest_depth_is_the_widest_fixed_format():
    assert NV2A.changed(depth_bits=(24, 16)).widest_depth == 24
    assert NV2A.widest_depth == 24 == GEFORCE_256.widest_depth


def test_widths_and_clamps_that_were_asked_for_say_so():
    narrow = GEFORCE_256.with_precision(combiner_bits=6, framebuffer_bits=5)
    assert narrow.arithmetic.combiner_bits == 6 and narrow.framebuffers.color_bits == (5,)
    assert narrow.facts["color_bits"].evidence == "Assumed: nothing; a width that was asked for"
    free = narrow.without_clamps(Clamp.BLENDING)
    assert free.arithmetic.clamps == frozenset(Clamp) - {Clamp.BLENDING}
    assert free.facts["clamps"].evidence == "Assumed: nothing; clamps that were asked to be off"
    assert free.facts["combiner_bits"] == narrow.facts["combiner_bits"]


def test_a_descendant_says_what_is_inherited_in_its_own_words():
    settled = known(4, "Assumed: for this test")
    made = NV2A.descendant(name="n", description="d", inherited="Inferred: from the NV2A", max_lights=settled)
    assert made.ancestor is NV2A and (made.name, made.description) == ("n", "d")
    assert made.facts["max_lights"] == settled
    assert {fact.evidence for name, fact in made.facts.items() if name != "max_lights"} == {
        "Inferred: from the NV2A"
    }
    assert all(
        fact.value == NV2A.facts[name].value for name, fact in made.facts.items() if name != "max_lights"
    )
    same = NV2A.descendant(name="n", description="d", max_lights=settled)
    assert same.facts["max_clip_planes"] == NV2A.facts["max_clip_planes"]
    with pytest.raises(ValueError, match="without evidence"):
        NV2A.descendant(name="n", description="d", max_lights=4)


def test_profiles_can_be_copied_and_sent():
    for profile in PROFILES.values():
        assert pickle.loads(pickle.dumps(profile)) == profile == copy.deepcopy(profile)


# ------------------------------------------------------------------------------------------------- drivers

DRIVEN = [(key, driver.name) for key, profile in PROFILES.items() for driver in profile.drivers]


def test_the_machines_with_drivers_are_those_whose_dates_are_known():
    assert {key for key, _ in DRIVEN} == {"GEFORCE_256", "GEFORCE_3"}
    assert len(set(DRIVEN)) == len(DRIVEN)


@pytest.mark.parametrize(("key", "name"), DRIVEN)
def test_a_driver_changes_what_it_says_and_nothing_else(key, name):
    own, made = PROFILES[key], PROFILES[key].with_driver(name)
    (driver,) = [d for d in own.drivers if d.name == name]
    assert (made.name, made.driver, made.changed_from) == (f"{own.name} with {name}", name, own)
    for field, fact in own.facts.items():
        assert made.facts[field] == driver.facts.get(field, fact), field
        if field in driver.facts:
            assert made.facts[field].value != fact.value, f"{field} is as without the driver"


def test_the_geforce_3_as_it_is_has_the_last_of_its_drivers():
    own = PROFILES["GEFORCE_3"]
    assert own.with_driver(own.drivers[-1].name).facts == own.facts


def test_drivers_stay_with_their_machine():
    assert PROFILES["GEFORCE_3"].changed(max_lights=1).drivers == PROFILES["GEFORCE_3"].drivers
    assert PROFILES["FUTURE"].drivers == () and PROFILES["FUTURE"].driver is None
    with pytest.raises(ValueError, match="no driver 'Release 9'; those known are 'Release 4', 'Release 5'"):
        GEFORCE_256.with_driver("Release 9")
    with pytest.raises(ValueError, match="none of its drivers is known"):
        NV2A.with_driver("Release 5")
    with pytest.raises(ValueError, match="has a driver already"):
        GEFORCE_256.with_driver("Release 4").with_driver("Release 5")
    later = [profile.driver for profile in GEFORCE_256.with_driver("Release 4").later_drivers()]
    assert later == ["Release 5", "a driver of 2001"]
