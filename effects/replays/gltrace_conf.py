"""The file gltrace.conf, with which apitrace lets a traced program see one of the machines.

Source: apitrace's docs/USAGE.markdown and wrappers/config.cpp: the file's name, its variables and their form.
"""

import re

from fixedpipe.pipeline.opengl.extensions import VERSION, extensions
from fixedpipe.pipeline.profiles.profile import Profile

# GL_VENDOR and GL_RENDERER by machine. Assumed: programs of the time looked for these; a driver of the time
# would settle it. For other machines they are what this project's GetString returns.
_NAMES = {
    "GEFORCE_256": ("NVIDIA Corporation", "GeForce 256/AGP/SSE"),
    "GEFORCE_3": ("NVIDIA Corporation", "GeForce3/AGP/SSE2"),
}
_WIDTH = 110  # columns of the list of extensions; apitrace accepts a string over several lines


def of_year(profile: Profile, year: int) -> Profile:
    """The machine with the newest of its dated drivers up to a year; the machine itself if it had no driver
    yet.
    """
    newest = None
    for driver in profile.drivers:
        found = re.search(r"\d{4}", driver.since)
        if found and int(found[0]) <= year:
            newest = driver
    return profile if newest is None else profile.with_driver(newest.name)


def conf_text(key: str, profile: Profile) -> str:
    """The text of gltrace.conf for the machine ``key``, from its ``profile``."""
    vendor, renderer = _NAMES.get(key, ("fixedpipe", profile.name))
    lines, line = [], 'GL_EXTENSIONS = "'
    for name in extensions(profile):
        if len(line) + len(name) > _WIDTH:
            lines.append(line.rstrip())
            line = ""
        line += f"{name} "
    lines.append(line.rstrip() + '"')
    return "\n".join(
        (
            f"# {profile.name}. Save it as ~/.config/apitrace/gltrace.conf, or name it in GLTRACE_CONF.",
            f'GL_VENDOR = "{vendor}"',
            f'GL_RENDERER = "{renderer}"',
            f'GL_VERSION = "{VERSION}"',
            *lines,
            f"GL_MAX_TEXTURE_SIZE = {profile.textures.max_texture_size}",
            "",
        )
    )
