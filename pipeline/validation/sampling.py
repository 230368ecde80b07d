"""Validation of samplers: filters and wrap modes, comparisons and footprint assembly."""

from fixedpipe.pipeline.enums import (
    TextureCompareMode,
    TextureFilter,
    TextureTarget,
    WrapMode,
)
from fixedpipe.pipeline.messages import count, listed
from fixedpipe.pipeline.state import SignedComponents
from fixedpipe.pipeline.textures.images import DEPTH_TEXELS, FORMATS_OF_WORDS
from fixedpipe.pipeline.validation.textures import complete_levels

_LOD_LIMIT = 1000.0  # the initial limits of table 3.17


def sampler(walk, unit, known, number):
    """Refuse a unit's sampler that the machine lacks, or that does not fit the texture ``known``."""
    profile, sampler, place = walk.profile, unit.sampler, f"texture unit {number}"
    if sampler.mag_filter not in (TextureFilter.NEAREST, TextureFilter.LINEAR):
        walk.refuse(
            f"{place} magnifies with {sampler.mag_filter.name}; a magnification filter is NEAREST or LINEAR."
        )
    for name in ("wrap_s", "wrap_t", "wrap_r"):
        if getattr(sampler, name) not in profile.textures.wrap_modes:
            walk.refuse(
                f"{profile.name} has no {getattr(sampler, name).name}, which {place} asks for {name}; "
                f"it has {listed(profile.textures.wrap_modes)}."
            )
    if sampler.compare_mode not in profile.textures.texture_compare_modes:
        walk.refuse(
            f"{profile.name} has no {sampler.compare_mode.name}, which {place} asks for compare_mode; it "
            f"has {listed(profile.textures.texture_compare_modes)}."
        )
    _comparison(walk, unit, known, place)
    _levels(walk, unit, known, place)
    _footprints(walk, unit, known, place)


def _comparison(walk, unit, known, place):
    """Refuse comparisons that the machine or the texture does not allow.

    A machine may read depth textures by comparisons alone. Only depth textures are compared.
    """
    profile, sampler = walk.profile, unit.sampler
    deep = known.internal_format in DEPTH_TEXELS
    compares = sampler.compare_mode is not TextureCompareMode.NONE
    read = f"{place} reads {unit.texture!r}, {known.internal_format.name}, with compare_mode "
    if compares and not deep:
        walk.refuse(f"{read}{sampler.compare_mode.name}; only depth textures are compared. Give NONE.")
    if deep and not compares and not _has_colors(profile, known.internal_format):
        walk.refuse(
            f"{read}NONE; {profile.name} reads such textures by comparing alone. Give a compare_mode, or "
            "store the depths in a format of colours."
        )
    if problem := _shadow_problem(place, sampler, profile, deep):
        walk.refuse(problem)


def _has_colors(profile, internal_format):
    """Whether the machine reads a depth texture of this format as colours; never one of floats."""
    return profile.textures.depths_as_colors and DEPTH_TEXELS[internal_format].form is None


def _levels(walk, unit, known, place):
    """Refuse a minification filter, base level or maximum level that the texture's levels do not allow."""
    sampler, given = unit.sampler, len(known.sizes)
    lowest, last = sampler.base_level, given - 1
    mipmapped = sampler.min_filter not in (TextureFilter.NEAREST, TextureFilter.LINEAR)
    if known.target is TextureTarget.TEXTURE_RECTANGLE:
        _rectangle_sampler(walk, place, sampler, mipmapped)
    if sampler.max_level < 0:
        walk.refuse(f"{place} has the maximum level {sampler.max_level}; levels count from 0.")
    if not 0 <= lowest <= last:
        walk.refuse(
            f"{place} has the base level {lowest}, but {unit.texture!r} has {count(given, 'level')}; give a "
            f"base_level from 0 to {last}."
        )
    if lowest > sampler.max_level:
        walk.refuse(
            f"{place} has the base level {lowest} above the maximum level {sampler.max_level}. Give a "
            "max_level that is not below base_level."
        )
    width, height = known.sizes[lowest]
    layers = known.faces[lowest] if known.target is TextureTarget.TEXTURE_3D else 1
    complete = lowest + complete_levels(width, max(height, layers))
    if mipmapped and given < min(complete, sampler.max_level + 1):
        width, height = known.sizes[0]
        walk.refuse(
            f"{place} minifies with {sampler.min_filter.name}, but {unit.texture!r} ({width}x{height}) "
            f"has {count(given, 'level')} of {complete}; build it with mipmaps=True, set "
            f"max_level to {last}, or set min_filter to LINEAR or NEAREST."
        )


def _footprints(walk, unit, known, place):
    """Refuse limits and biases of the level of detail, and footprints, that the machine lacks."""
    profile, sampler = walk.profile, unit.sampler
    if abs(sampler.min_lod) > _LOD_LIMIT or abs(sampler.max_lod) > _LOD_LIMIT:
        walk.refuse(
            f"{place} limits the level of detail to {sampler.min_lod} .. {sampler.max_lod}; give limits "
            f"from -{_LOD_LIMIT:g} to {_LOD_LIMIT:g}."
        )
    if not 1 <= sampler.max_anisotropy <= profile.textures.max_anisotropy:
        walk.refuse(
            f"{place} has the maximum anisotropy {sampler.max_anisotropy:g}; {profile.name} takes 1 to "
            f"{profile.textures.max_anisotropy:g}. Set max_anisotropy to one of these."
        )
    if sampler.max_anisotropy > 1 and (
        known.target not in (TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_RECTANGLE)
        or known.internal_format in FORMATS_OF_WORDS
    ):
        walk.refuse(
            f"{place} filters {unit.texture!r} anisotropically; how is known of 2D and rectangle "
            "textures of bytes alone: set max_anisotropy to 1."
        )
    if problem := _probes_problem(place, sampler, known.target, known.internal_format, profile):
        walk.refuse(problem)
    if sampler.signed_components != SignedComponents() and not profile.textures.signed_components:
        walk.refuse(f"{profile.name} has no signed texels; bias them and use EXPAND_NORMAL mappings.")
    if abs(unit.lod_bias) > profile.textures.max_lod_bias:
        least = -profile.textures.max_lod_bias or 0.0
        walk.refuse(
            f"{place} has the level-of-detail bias {unit.lod_bias}; {profile.name} takes {least} to "
            f"{profile.textures.max_lod_bias}. Set lod_bias to one of these."
        )


def _rectangle_sampler(walk, place, sampler, mipmapped):
    if mipmapped:
        walk.refuse(
            f"{place} minifies a TEXTURE_RECTANGLE with {sampler.min_filter.name}; rectangles have no "
            "mipmaps. Give NEAREST or LINEAR."
        )
    for name in ("wrap_s", "wrap_t"):
        mode = getattr(sampler, name)
        if mode in (WrapMode.REPEAT, WrapMode.MIRRORED_REPEAT):
            walk.refuse(
                f"{place} asks for {name} {mode.name} of a TEXTURE_RECTANGLE, whose coordinates count "
                "texels; give CLAMP, CLAMP_TO_EDGE or CLAMP_TO_BORDER."
            )


def _shadow_problem(place, sampler, profile, deep):
    """A sentence that says what is wrong with a sampler's comparison, or None.

    ``place`` names the texture unit. ``deep`` says whether the unit reads a depth texture.
    """
    mode, value = sampler.depth_texture_mode, sampler.compare_fail_value
    compares = sampler.compare_mode is not TextureCompareMode.NONE
    if compares and sampler.compare_function not in profile.textures.shadow_functions:
        return (
            f"{profile.name} does not compare textures by {sampler.compare_function.name}, which {place} "
            f"asks for; give one of {listed(profile.textures.shadow_functions)}."
        )
    if value != 0 and not (compares and profile.textures.shadow_ambient):
        return f"{place} has the compare_fail_value {value:g}; " + (
            f"{profile.name} has no shadow ambient. Give 0, and add ambient light in a pass of its own."
            if compares
            else "it takes part in comparisons alone. Give 0, or a compare_mode."
        )
    if not 0 <= value <= 1:
        return f"{place} has the compare_fail_value {value:g}; give 0 to 1."
    if mode is not None and not deep:
        return f"{place} has the depth_texture_mode {mode.name}, and its texture holds no depths. Give None."
    if mode is not None and mode not in profile.textures.depth_texture_modes:
        has = listed(profile.textures.depth_texture_modes)
        return f"{place} has the depth_texture_mode {mode.name}; {profile.name} has {has}. Give None."
    return None


def _probes_problem(place, sampler, target, internal_format, profile):
    """A sentence that says what is wrong with a sampler's footprint assembly, or None."""
    probes, exact = sampler.max_probes, sampler.exact_probes
    if exact and not profile.textures.exact_probes:
        has = "powers of two" if profile.textures.max_probes > 1 else "no probes"
        return f"{place} has exact_probes; {profile.name} has {has}. Leave exact_probes out."
    if probes < 1 or (probes & (probes - 1) and not exact):
        way = "" if not profile.textures.exact_probes else ", or set exact_probes"
        return f"{place} assembles footprints of {probes} probes; give a power of two{way}, or 1 for none."
    if probes > profile.textures.max_probes:
        most = profile.textures.max_probes
        given = f"{place} assembles footprints of {probes} probes"
        return f"{given}; {profile.name} takes up to {most}: set max_probes to it."
    if probes == 1:
        return None
    flat = target in (TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_RECTANGLE)
    if not flat or internal_format in FORMATS_OF_WORDS:
        return (
            f"{place} assembles footprints of a {target.name} of {internal_format.name}; {profile.name} does "
            "so of 2D and rectangle textures of bytes: set max_probes to 1."
        )
    if sampler.max_anisotropy > 1:
        both = f"max_probes {probes} and max_anisotropy {sampler.max_anisotropy:g}"
        return f"{place} has {both}; {profile.name} filters by one of them. Set the other to 1."
    return None
