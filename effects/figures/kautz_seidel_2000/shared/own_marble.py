"""The marble of F004-6 and F004-7, or a user's photograph and height field as marble."""

from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.reflectance import material_textures

# The parameters of both figures.
OWN = {
    "photograph": own_maps.photograph(
        "the stone's colours, whose dark parts are raised and have the veins' alpha_y"
    ),
    "height_field": own_maps.height_field("the veins' relief"),
    "height_scale": own_maps.HEIGHT_SCALE(0.02),
}


def marble(size, height_field, height_scale, photograph, **veins):
    """``material_textures.marble`` of ``size`` and ``veins``, or the user's own in their place."""
    stone = material_textures.marble(size, **veins)
    if height_field is None and photograph is None:
        return stone
    colors, darkness = stone.colors, stone.darkness
    if photograph is not None:
        colors = photograph.fitted(size, size, repeated=True)
        darkness = 1.0 - photograph.brightness(size, size, repeated=True)
    if height_field is None:
        slopes = height_fields.slopes(height_fields.smooth(darkness) * (veins["relief"] / size))
    else:
        slopes = height_field.slopes(size, height_scale, repeated=True)
    light, dark = veins["alpha_y"]
    alpha_y = light + (dark - light) * darkness
    material = material_textures.from_slopes(*slopes, veins["alpha_x"], alpha_y, veins["k_s"])
    return material_textures.Marble(material, colors, darkness)
