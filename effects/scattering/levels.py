"""G31: levels of detail that agree: geometry, a bump map and a BRDF of one height field and its visibility.

The size of the field's texels in pixels selects the level. Geometry is for texels of several pixels, a bump
map for texels of a pixel's size, and the BRDF for many texels in a pixel. Around each limit, two levels fade
into each other.

Source: Heidrich, Daubert, Kautz, Seidel 2000, sections 1 and 6; pass sequence A-G31. Assumed: the limits and
the fading; the paper says that the levels agree, but gives no numbers.
"""

from fixedpipe.effects.technique import Technique

TECHNIQUES = (Technique("G31", "geometry, bump map or BRDF of a height field, by its size", "1, 6"),)

# Texels a pixel at which a bump map, and a BRDF, is as much as what is nearer.
BUMP_MAP, BRDF = 0.25, 4.0
# Two levels are mixed within this share of a limit to either side.
FADE = 0.5


def shares(texels_a_pixel):
    """How much of the picture is geometry, bump map and BRDF: three numbers that sum to one.

    Raises ValueError where there are no texels a pixel.
    """
    if not texels_a_pixel > 0.0:
        raise ValueError(f"There are {texels_a_pixel!r} texels a pixel; give a number above 0.")

    def beyond(limit):
        return min(max((texels_a_pixel / limit - 1.0) / (2.0 * FADE) + 0.5, 0.0), 1.0)

    bump, brdf = beyond(BUMP_MAP), beyond(BRDF)
    return 1.0 - bump, bump - brdf, brdf
