"""What a sampler may ask of a machine beside filters and wrap modes: comparisons and footprint assembly."""

from pipeline.enums import InternalFormat, TextureCompareMode, TextureTarget


def _names(members):
    return ", ".join(m.name for m in sorted(members)) or "none"


def shadow_problem(place, sampler, profile):
    """What is wrong with a sampler's comparison, a sentence, or None. ``place``: which texture unit."""
    mode, value = sampler.depth_texture_mode, sampler.compare_fail_value
    compares = sampler.compare_mode is not TextureCompareMode.NONE
    if compares and sampler.compare_function not in profile.shadow_functions:
        return (
            f"{profile.name} does not compare textures by {sampler.compare_function.name}, which {place} "
            f"asks for; give one of {_names(profile.shadow_functions)}."
        )
    if value != 0 and not (compares and profile.shadow_ambient):
        return f"{place} has the compare_fail_value {value:g}; " + (
            f"{profile.name} has no shadow ambient. Give 0, and add ambient light in a pass of its own."
            if compares
            else "it takes part in comparisons alone. Give 0, or a compare_mode."
        )
    if not 0 <= value <= 1:
        return f"{place} has the compare_fail_value {value:g}; give 0 to 1."
    if mode is not None and not (compares and mode in profile.depth_texture_modes):
        has = _names(profile.depth_texture_modes) if compares else "none without a compare_mode"
        return f"{place} has the depth_texture_mode {mode.name}; {profile.name} has {has}. Give None."
    return None


def probes_problem(place, sampler, target, internal_format, profile):
    """What is wrong with a sampler's footprint assembly, a sentence, or None."""
    probes = sampler.max_probes
    if probes < 1 or probes & (probes - 1):
        return f"{place} assembles footprints of {probes} probes; give a power of two, or 1 for none."
    if probes > profile.max_probes:
        most = profile.max_probes
        given = f"{place} assembles footprints of {probes} probes"
        return f"{given}; {profile.name} takes up to {most}: set max_probes to it."
    if probes == 1:
        return None
    flat = target in (TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_RECTANGLE)
    if not flat or internal_format is InternalFormat.HILO16:
        return (
            f"{place} assembles footprints of a {target.name} of {internal_format.name}; {profile.name} does "
            "so of 2D and rectangle textures of bytes: set max_probes to 1."
        )
    if sampler.max_anisotropy > 1:
        both = f"max_probes {probes} and max_anisotropy {sampler.max_anisotropy:g}"
        return f"{place} has {both}; {profile.name} filters by one of them. Set the other to 1."
    return None
