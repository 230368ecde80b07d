"""Which package may import which; ``python -m tests.layers`` writes the table into docs/architecture.md.

test_layers holds the code to it in both directions: what is not listed may not be imported, and what is
listed is. A package imports only what stands above it, so there is no circle.
"""

from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "architecture.md"
BEGIN, END = "<!-- packages: begin -->\n", "<!-- packages: end -->\n"

# By layer, a package or a module that stands at the layer's door, and what it imports of each layer. Folders
# below these packages (a paper's figures, suites, what studies share) are the package's.
PACKAGES = {
    "raster/codes": {},
    "raster/floats": {},
    "raster/float_depths": {"raster": "codes floats"},
    "raster/rows": {"raster": "codes"},
    "raster/kernel_files": {},
    "raster/kernel_folder": {},
    "raster/kernel_levels": {},
    "raster/kernel_packs": {"raster": "kernel_levels"},
    "raster/kernel": {"raster": "kernel_files kernel_folder kernel_packs"},
    "raster/observer": {},
    "raster/arrays": {},
    "raster/fixed": {"raster": "codes floats float_depths kernel"},
    "raster/primitives": {"raster": "codes floats rows kernel"},
    "raster/portable": {"raster": "codes floats rows kernel arrays fixed primitives"},
    "raster/vector": {"raster": "codes floats rows kernel arrays fixed primitives portable"},
    "raster/columns": {"raster": "codes floats float_depths observer"},
    "raster/pixel_groups": {"raster": "kernel"},
    "raster/pixels": {"raster": "codes"},
    "pipeline/enums": {"raster": "codes"},
    "pipeline/messages": {"pipeline": "enums"},
    "pipeline/state": {"pipeline": "enums"},
    "pipeline/pixel_transfer": {"pipeline": "enums state"},
    "pipeline/interned_states": {"pipeline": "state"},
    "pipeline/state_kinds": {"pipeline": "state interned_states"},
    "pipeline/textures": {"raster": "codes float_depths", "pipeline": "enums state"},
    "pipeline/commands": {"pipeline": "enums state pixel_transfer textures"},
    "pipeline/multi_draw": {"pipeline": "state commands"},
    "pipeline/interned_commands": {"pipeline": "state interned_states commands"},
    "pipeline/profiles": {"pipeline": "enums textures"},
    "pipeline/programs": {"raster": "codes", "pipeline": "enums messages state textures"},
    "pipeline/notations": {"pipeline": "enums state programs"},
    "pipeline/description": {
        "pipeline": "enums messages state pixel_transfer commands multi_draw programs notations"
    },
    "pipeline/vertices": {
        "raster": "codes floats rows primitives",
        "pipeline": "enums state commands profiles",
    },
    "pipeline/framebuffers": {
        "raster": "codes rows primitives columns pixel_groups pixels",
        "pipeline": "enums state pixel_transfer textures commands profiles",
    },
    "pipeline/opengl": {
        "raster": "pixels",
        "pipeline": ("enums state pixel_transfer textures commands profiles programs vertices framebuffers"),
    },
    "pipeline/validation": {
        "pipeline": (
            "enums messages state pixel_transfer interned_states state_kinds textures commands multi_draw"
            " profiles programs vertices"
        ),
    },
    "pipeline/native": {
        "raster": "codes floats rows arrays primitives portable vector columns",
        "pipeline": "enums state state_kinds textures commands profiles programs vertices framebuffers",
    },
    "pipeline/columns": {
        "raster": "codes rows observer columns pixels",
        "pipeline": "enums pixel_transfer textures commands profiles programs vertices framebuffers",
    },
    "pipeline/execution": {
        "raster": "observer primitives",
        "pipeline": (
            "enums interned_states textures commands multi_draw profiles vertices framebuffers validation"
            " native columns"
        ),
    },
    "pipeline/ideal": {
        "raster": "codes fixed floats rows kernel observer primitives portable columns",
        "pipeline": (
            "enums state pixel_transfer textures commands multi_draw profiles programs vertices framebuffers "
            "validation native columns"
        ),
    },
    "pipeline/inspection": {
        "raster": "codes observer columns",
        "pipeline": (
            "enums messages state textures commands multi_draw profiles programs notations description "
            "vertices framebuffers validation native columns execution ideal"
        ),
    },
    "pipeline/traces": {},
    "pipeline/selftest": {
        "raster": "kernel kernel_levels",
        "pipeline": ("enums state pixel_transfer textures commands profiles framebuffers native execution"),
    },
    "pipeline/golden": {
        "raster": "kernel",
        "pipeline": (
            "enums state textures commands multi_draw profiles notations framebuffers validation native "
            "execution inspection selftest"
        ),
    },
    "effects/refusal": {},
    "effects/tasks": {"pipeline": "native selftest", "effects": "refusal"},
    "effects/source_digests": {},
    "effects/computed_once": {"effects": "source_digests"},
    "effects/collection": {"effects": "refusal"},
    "effects/technique": {},
    "effects/bibliography": {},
    "effects/geometry": {"raster": "kernel", "pipeline": "state textures commands"},
    "effects/passes": {
        "pipeline": "enums messages state pixel_transfer textures commands",
        "effects": "technique",
    },
    "effects/scenes": {"effects": "geometry passes"},
    "effects/bump_mapping": {
        "pipeline": "enums state pixel_transfer textures commands",
        "effects": "technique geometry passes",
    },
    "effects/reflectance": {
        "raster": "kernel",
        "pipeline": "enums state pixel_transfer textures commands profiles",
        "effects": "technique geometry passes bump_mapping",
    },
    "effects/texture_filtering": {
        "raster": "kernel",
        "pipeline": "enums state textures commands native",
        "effects": "computed_once technique geometry passes bump_mapping reflectance",
    },
    "effects/environment_maps": {
        "raster": "kernel",
        "pipeline": "enums state pixel_transfer textures commands native",
        "effects": "computed_once technique geometry passes bump_mapping reflectance texture_filtering",
    },
    "effects/radiosity": {
        "pipeline": "enums textures commands",
        "effects": "technique geometry passes",
    },
    "effects/shadows": {
        "raster": "kernel",
        "pipeline": "enums state pixel_transfer textures commands",
        "effects": "technique geometry passes scenes",
    },
    "effects/scattering": {
        "raster": "kernel",
        "pipeline": "enums state pixel_transfer textures commands native",
        "effects": "refusal technique geometry passes bump_mapping",
    },
    "effects/volumes": {
        "pipeline": "enums state pixel_transfer textures commands",
        "effects": "technique geometry passes scenes shadows",
    },
    "effects/acceptance": {
        "raster": "kernel",
        "pipeline": "enums commands execution ideal inspection",
        "effects": "geometry passes scenes reflectance shadows scattering",
    },
    "effects/data_files": {"effects": "refusal acceptance"},
    "effects/diagrams": {
        "pipeline": "enums state textures commands",
        "effects": "geometry passes acceptance",
    },
    "effects/user_pictures": {
        "pipeline": "enums profiles validation execution ideal",
        "effects": (
            "refusal geometry passes scenes bump_mapping reflectance texture_filtering environment_maps "
            "shadows volumes scattering acceptance"
        ),
    },
    "effects/figures": {
        "pipeline": (
            "enums state pixel_transfer textures commands interned_commands profiles framebuffers execution "
            "ideal"
        ),
        "effects": (
            "refusal computed_once collection geometry passes scenes bump_mapping reflectance "
            "environment_maps radiosity texture_filtering shadows volumes scattering acceptance data_files "
            "diagrams user_pictures"
        ),
    },
    "effects/studies": {
        "pipeline": "enums state pixel_transfer textures commands profiles validation execution ideal",
        "effects": (
            "collection geometry passes scenes bump_mapping reflectance environment_maps shadows scattering "
            "texture_filtering acceptance data_files figures"
        ),
    },
    "effects/arithmetic": {
        "raster": "codes portable columns",
        "pipeline": "enums state textures profiles vertices framebuffers columns golden",
    },
    "effects/emulators": {"effects": "refusal arithmetic"},
    "effects/conformance": {
        "pipeline": (
            "enums state textures commands profiles vertices framebuffers validation native execution"
        ),
        "effects": "refusal tasks passes",
    },
    "effects/presentation": {
        "pipeline": "profiles",
        "effects": "refusal bibliography geometry acceptance figures",
    },
    "effects/reports": {
        "pipeline": "enums commands profiles framebuffers native execution ideal inspection golden",
        "effects": (
            "refusal tasks source_digests computed_once technique bibliography geometry acceptance "
            "data_files figures arithmetic emulators conformance presentation"
        ),
    },
    "effects/nv2a_frames": {
        "pipeline": "enums state textures commands profiles notations execution",
        "effects": "refusal conformance",
    },
    "effects/pixel_states": {
        "pipeline": ("enums messages state textures commands profiles notations validation inspection"),
        "effects": "refusal",
    },
    "effects/replays": {
        "pipeline": (
            "enums messages state pixel_transfer textures commands profiles framebuffers opengl validation "
            "execution ideal traces"
        ),
        "effects": "refusal reports",
    },
    "effects/sweeps": {
        "pipeline": "profiles framebuffers execution ideal golden",
        "effects": "refusal tasks acceptance figures studies reports presentation",
    },
    "effects/viewer": {
        "pipeline": ("enums commands profiles description framebuffers execution ideal inspection golden"),
        "effects": "refusal geometry reflectance user_pictures figures reports",
    },
    "effects/cli": {
        "raster": "kernel kernel_folder kernel_levels kernel_packs",
        "pipeline": (
            "enums messages multi_draw profiles notations description framebuffers validation native "
            "inspection selftest golden"
        ),
        "effects": (
            "refusal technique bump_mapping volumes scattering acceptance figures studies arithmetic "
            "emulators conformance user_pictures reports nv2a_frames pixel_states replays presentation "
            "sweeps tasks viewer"
        ),
    },
}
# Libraries beside NumPy, which every package may import.
LIBRARIES = {
    "raster/kernel_files": ("numba",),
    "raster/kernel_levels": ("llvmlite", "numba"),
    "raster/kernel_packs": ("llvmlite", "numba"),
    "raster/kernel": ("llvmlite", "numba"),
    "raster/arrays": ("numba",),
    "raster/fixed": ("numba",),
    "raster/primitives": ("numba",),
    "raster/portable": ("numba",),
    "raster/vector": ("llvmlite", "numba"),
    "pipeline/framebuffers": ("PIL",),
    "effects/figures": ("PIL",),
    "pipeline/native": ("numba",),
    "pipeline/ideal": ("numba",),
    "pipeline/selftest": ("llvmlite", "numba"),
    "pipeline/traces": ("brotli", "cramjam"),
    "pipeline/golden": ("PIL", "pytest", "syrupy"),
    "effects/scattering": ("scipy",),
    "effects/texture_filtering": ("PIL",),
    "effects/diagrams": ("PIL",),
    "effects/conformance": ("PIL",),
    "effects/user_pictures": ("PIL", "nrrd", "tifffile", "plyfile", "OpenImageIO", "OpenEXR"),
    "effects/reports": ("PIL", "matplotlib", "flip_evaluator", "markdown_it"),
    "effects/replays": ("PIL",),
    "effects/presentation": ("PIL", "imageio", "imageio_ffmpeg", "matplotlib"),
    "effects/tasks": ("dask", "distributed", "loky", "mpi4py"),
    "effects/sweeps": ("matplotlib", "pyarrow", "xarray"),
    "effects/viewer": ("anywidget", "starlette", "traitlets", "uvicorn"),
    "effects/cli": ("PIL", "click", "rich"),
}


def imports_of(package):
    """The packages that a package may import, by their folders."""
    return tuple(f"{layer}/{name}" for layer, names in PACKAGES[package].items() for name in names.split())


def table():
    """The packages as docs/architecture.md shows them."""
    lines = ["| package | imports | libraries |", "|---|---|---|"]
    for package, imports in PACKAGES.items():
        listed = "; ".join(f"{layer}: {names.replace(' ', ', ')}" for layer, names in imports.items())
        lines.append(f"| `{package}` | {listed} | {', '.join(LIBRARIES.get(package, ()))} |")
    return "\n".join(lines) + "\n"


def with_table(page):
    """The page's text with the table as it is now."""
    before, rest = page.split(BEGIN)
    return before + BEGIN + "\n" + table() + "\n" + END + rest.split(END)[1]


if __name__ == "__main__":
    PAGE.write_text(with_table(PAGE.read_text()))
