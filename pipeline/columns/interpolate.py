"""From primitives to fragments in the column engine: coverage, and iteration over a primitive."""

import numpy as np

from fixedpipe.pipeline.columns.combiners import arithmetic_of
from fixedpipe.pipeline.columns.fragments import FragmentColumns, fragment_depths
from fixedpipe.pipeline.columns.textures import unit_samplers
from fixedpipe.pipeline.enums import (
    Clamp,
    ColorWeights,
    FogArithmetic,
    FrontFace,
    LineRasterization,
    ShadeModel,
)
from fixedpipe.pipeline.framebuffers.bounds import scissor_box
from fixedpipe.pipeline.framebuffers.depths import depth_units
from fixedpipe.pipeline.programs.texture_shader_rules import shader_stages
from fixedpipe.pipeline.vertices.colors import COLOR_REACH, fragment_colors
from fixedpipe.pipeline.vertices.strokes import whole_size
from fixedpipe.raster import codes as C
from fixedpipe.raster import rows
from fixedpipe.raster.columns import future, interpolate
from fixedpipe.raster.columns.numbers import INTEGERS, one_of
from fixedpipe.raster.columns.w_slope import w_slope
from fixedpipe.raster.observer import unobserved


class IteratedPrimitives:
    """Primitives, with the state that iteration needs.

    ``observe``: the observer. ``numbers``: INTEGERS, or REALS for colours without rounding.
    """

    def __init__(
        self, primitives, state, profile, framebuffer, textures, bits, observe=unobserved, numbers=INTEGERS
    ):
        self._saw, self.numbers = observe, numbers
        self.primitives, self.state, self.profile = primitives, state, profile
        self.framebuffer, self.bits = framebuffer, bits
        self.colors = fragment_colors(primitives.colors, state, profile, bits)
        if not numbers.rounds:
            limited = np.clip(np.nan_to_num(primitives.colors), -COLOR_REACH, COLOR_REACH)
            self.colors = numbers.fixed(limited, one_of(bits))
        self.depths = depth_units(state, framebuffer, primitives)
        self.units = unit_samplers(state, textures, profile)
        self.divided = tuple(primitives.projective[: len(self.units)])
        self.rough = {i: s for i, s in enumerate(shader_stages(state) or ()) if s.roughness is not None}

    def fragments(self, triangle, px, py):
        """The FragmentColumns at pixels (px, py) of the rows ``triangle``."""
        p, state, profile = self.primitives, self.state, self.profile
        px, py = px.astype(np.int64), py.astype(np.int64)
        corners = p.triangles[triangle].astype(np.int64)
        vertices, provoking = corners[:, :3], corners[:, 3]
        x, y = p.x[vertices].astype(np.int64), p.y[vertices].astype(np.int64)
        kinds = p.strokes[triangle, rows.KIND] if len(p.strokes) else None
        area = interpolate.edge_functions(x, y, px, py, profile.arithmetic.subpixel_bits)[1]

        n, inverse_w = self._edges(x, y, kinds, px, py, True), p.inverse_w[vertices]
        e = interpolate.perspective_terms(n, inverse_w)
        b0, b2, _ = interpolate.full_weights(e)
        q0, q2 = interpolate.iteration_weights(n, inverse_w)
        back = self._back(kinds, triangle, area * np.sign(inverse_w).prod(axis=1))
        primary, secondary = self._colors(vertices, provoking, back, e, (q0, q2), (b0, b2))
        if self.state.polygon.shade_model == ShadeModel.SMOOTH:
            corners = self.colors[vertices, back[:, None]]
            if state.spherical_primary_color:
                primary = self._turned(primary, corners[:, :, :3], b0, b2)
            if state.spherical_secondary_color:
                secondary = self._turned(secondary, corners[:, :, 4:7], b0, b2)
        fog = None
        if state.fog is not None:
            fog = self._fog(vertices, q0, q2, b0, b2)

        def edges(px, py):
            return self._edges(x, y, kinds, px, py)

        self._saw(
            "iteration", triangle=triangle, vertices=vertices, provoking=provoking, x=x, y=y, area=area,
            edges=n, inverse_w=inverse_w, weights=(q0, (1.0 - q0) - q2, q2),
            full_weights=(b0, (1.0 - b0) - b2, b2), back=back, primary=primary,
            corners=self.colors[vertices, back[:, None]], secondary=secondary, fog=fog,
        )  # fmt: skip
        coordinates, lod, footprints = self._coordinates(vertices, edges, inverse_w, (q0, q2, b0, b2), px, py)
        sides = self._sides(vertices, edges, inverse_w, px, py)
        depth = self._depth(triangle, vertices, kinds, n, (q0, q2), x, y, area)
        return FragmentColumns(
            px, py, depth, primary, secondary, fog, coordinates, lod, self.divided, footprints, sides
        )

    def _fog(self, vertices, q0, q2, b0, b2):
        """The iterated fog coordinate. Under TABLE it is iterated as texture coordinates are."""
        corners = self.primitives.fog[vertices]
        if self.profile.arithmetic.fog_arithmetic == FogArithmetic.TABLE:
            return interpolate.iterate_coordinates(q0, q2, corners[..., None])[0][:, 0]
        return interpolate.iterate(b0, b2, corners)

    def _edges(self, x, y, kinds, px, py, drawn=False):
        """The edge functions (n0, n1, n2) at pixels.

        ``drawn``: for the fragments themselves. In a wide line with diamond exit these repeat another pixel's
        values.
        """
        line, bits = self.state.line, self.profile.arithmetic.subpixel_bits
        n, _ = interpolate.edge_functions(x, y, px, py, bits)
        if kinds is None or not (lines := kinds == C.PRIMITIVE_LINE).any():
            return n
        if self.profile.arithmetic.diamond_exit_lines:
            width = whole_size(line.width)
            if drawn and width > 1:
                px, py = interpolate.repeated_pixels(x, y, px, py, width, bits)
            along = interpolate.along_diamonds(x, y, px, py, width, bits)
        else:
            steps = line.rasterization == LineRasterization.STEPS
            along = interpolate.along_lines(x, y, px, py, steps, bits)
        return tuple(np.where(lines, a, b) for a, b in zip(along, n, strict=True))

    def _back(self, kinds, triangle, area):
        """Which colour each fragment takes: 0 the front, 1 the back."""
        p = self.primitives
        if not p.two_side:
            facing = np.zeros(len(area), np.int64)
        else:  # y points down, so a negative area is counter-clockwise
            counter_clockwise = self.state.polygon.front_face == FrontFace.CCW
            facing = ((area < 0) != counter_clockwise).astype(np.int64)
        if kinds is None:
            return facing
        return np.where(kinds == C.PRIMITIVE_TRIANGLE, facing, p.strokes[triangle, rows.BACK])

    def _colors(self, vertices, provoking, back, e, weights, full_weights):
        """Primary and secondary colours.

        ``weights``, ``full_weights``: the weights of vertices 0 and 2, with 24 bits and in float64.
        """
        if self.state.polygon.shade_model == ShadeModel.FLAT:
            colors = self.colors[provoking, back]
        elif not self.numbers.rounds:
            corners = self.colors[vertices, back[:, None]]
            colors = np.clip(interpolate.iterate(*full_weights, corners), corners.min(1), corners.max(1))
        elif self.profile.arithmetic.color_weights == ColorWeights.EIGHT_BITS:
            corners = self.colors[vertices, back[:, None]]
            colors = interpolate.iterate_colors(*weights, corners, self.bits)
        else:  # ColorWeights.EXACT
            corners = self.colors[vertices, back[:, None]]
            one, clamps = one_of(self.bits), Clamp.VERTEX_COLOR in self.profile.arithmetic.clamps
            low, high = (0, one) if clamps else (-COLOR_REACH * one, COLOR_REACH * one)
            colors = interpolate.iterate_exact_colors(e, corners, low, high)
        return colors[:, :4], colors[:, 4:]

    def _turned(self, color, corners, b0, b2):
        """A colour whose red, green and blue encode a unit vector; the vector turns steadily (section 20)."""
        one, expanded = one_of(self.bits), arithmetic_of(self.profile, self.bits).expanded
        vector = future.spherical(b0, b2, future.from_color(corners, one, expanded))
        return np.concatenate([future.to_color(vector, one, expanded), color[:, 3:]], axis=1)

    def _coordinates(self, vertices, edges, inverse_w, weights, px, py):
        """Every unit's coordinates, and lambda and footprints for the units that need them."""
        count, units = len(px), len(self.units)
        q0, q2, b0, b2 = weights
        coordinates, lod, footprints = np.zeros((count, units, 4)), np.zeros((count, units)), None
        for k, (given, unit) in enumerate(zip(self.state.texture_units, self.units, strict=True)):
            if given is None:
                continue
            corners = self.primitives.coordinates[vertices, k]
            coordinates[:, k], _ = interpolate.iterate_coordinates(q0, q2, corners)
            if given.spherical_coordinates:
                coordinates[:, k, :3] = future.spherical(b0, b2, corners[:, :, :3])
            if unit is None or k in self.rough:
                continue
            if not (unit.needs_lambda or unit.anisotropic or unit.probes):
                continue
            target, sizes = unit.texture.target, unit.sizes
            steps, plain, missing = interpolate.block_steps(
                edges, inverse_w, corners, self.divided[k], target, sizes, px, py
            )
            if unit.anisotropic or unit.probes:
                footprints = np.zeros((count, units, 3)) if footprints is None else footprints
                footprint, most = interpolate.anisotropy, (float(unit.sampler.max_anisotropy),)
                if unit.probes:
                    most = float(unit.sampler.max_probes), unit.sampler.exact_probes
                    footprint = interpolate.probes
                footprints[:, k], found = footprint(plain, sizes, missing, *most)
            else:
                found = interpolate.level_of_detail(steps, missing, target)
            lod[:, k] = found / 256.0
            self._saw("level of detail", unit=k, steps=plain, sizes=sizes, missing=missing, lod=lod[:, k])
        return coordinates, lod, footprints

    def _sides(self, vertices, edges, inverse_w, px, py):
        """Pixels' footprints for lookups filtered by roughness: ``sides`` of FragmentColumns."""
        if not self.rough:
            return None
        out = np.full((len(px), len(self.units), 4), np.nan)
        for i, stage in self.rough.items():
            corners = self.primitives.coordinates[vertices, i]
            if stage.operation in C.OPERATIONS_OF_TWO_DOT_PRODUCTS:
                s, t = (self.primitives.coordinates[vertices, k, 2] for k in (i - 1, i))
                corners = np.stack([s, t, corners[..., 2], corners[..., 3]], axis=2)
            unit = self.units[i]
            _, plain, missing = interpolate.block_steps(
                edges, inverse_w, corners, False, unit.texture.target, unit.sizes, px, py
            )
            scaled = [step[:, :2] * np.array(unit.sizes[:2]) for step in plain]
            out[:, i] = np.where(missing[:, None], np.nan, np.concatenate(scaled, axis=1))
        return out

    def _depth(self, triangle, vertices, kinds, n, weights, x, y, area):
        """Words of the depth buffer; -1 where a depth limit discards the fragment (section 5)."""
        state, limits = self.state, self.state.depth_clamp
        if state.depth_test is None and not (limits is not None and limits.cull):
            return np.zeros(len(triangle), np.int64)
        corners = self.depths[vertices]
        if state.w_buffering:
            z = interpolate.iterate_w(*weights, corners)
        else:
            if kinds is not None:  # a line's first vertex comes before its second
                line = kinds == C.PRIMITIVE_LINE
                n = tuple(np.where(line, a, b) for a, b in zip(n[::-1], n, strict=True))
                corners = np.where(line[:, None], corners[:, ::-1], corners)
            z = interpolate.iterate_depth(n, corners)
        offset = self._offset(triangle, vertices, kinds, x, y, area)
        total = z + offset
        words = fragment_depths(total, state, self.framebuffer)
        self._saw("depth", iterated=z, offset=offset, total=total, words=words)
        return words

    def _offset(self, triangle, vertices, kinds, x, y, area):
        """The polygon offset of each fragment, by the polygon that it belongs to."""
        polygon, p = self.state.polygon, self.primitives
        enabled = np.full(len(triangle), polygon.offset_fill)
        if kinds is not None:
            of_kind = np.array([polygon.offset_fill, polygon.offset_line, polygon.offset_point])
            source = p.strokes[triangle, rows.SOURCE : rows.SOURCE + 3].astype(np.int64)
            stroke = kinds != C.PRIMITIVE_TRIANGLE
            enabled = of_kind[kinds] & (~stroke | (source[:, 0] >= 0))
            vertices = np.where(stroke[:, None] & (source[:, :1] >= 0), source, vertices)
            x, y = p.x[vertices].astype(np.int64), p.y[vertices].astype(np.int64)
            area = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0])
        if not enabled.any() or not (polygon.offset_factor or polygon.offset_units):
            return 0.0
        if self.state.w_buffering:
            steep = polygon.offset_factor * self._w_slopes(vertices, enabled)
        else:
            subpixel_bits = self.profile.arithmetic.subpixel_bits
            depths = self.depths[vertices]
            steep = interpolate.depth_slope(x, y, area, depths, polygon.offset_factor, subpixel_bits)
        offset = np.clip(polygon.offset_units + steep, -(2.0**128), 2.0**128)
        fraction = self.framebuffer.depth_format.is_float or self.profile.arithmetic.offset_fraction
        if not (fraction or self.state.w_buffering):
            offset = np.trunc(np.clip(offset, -(2.0**30), 2.0**30))
        return np.where(enabled, offset, 0.0)

    def _w_slopes(self, vertices, enabled):
        """The slope of w of each fragment's polygon; 0 where the fragment has no offset."""
        p, box = self.primitives, scissor_box(self.state, self.framebuffer)
        slopes = np.zeros(len(vertices))
        if not self.state.polygon.offset_factor:
            return slopes
        polygons, polygon_of = np.unique(vertices[enabled], axis=0, return_inverse=True)
        of_polygons = [
            w_slope(p.x[v].astype(np.int64), p.y[v].astype(np.int64), self.depths[v], p.inverse_w[v], box,
                    self.profile.arithmetic.subpixel_bits)
            for v in polygons
        ]  # fmt: skip
        slopes[enabled] = np.array(of_polygons)[polygon_of.ravel()]
        return slopes
