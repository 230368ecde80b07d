"""NVIDIA GeForce 3 (NV20, 2001), the NV2A's desktop sibling: no captures of its own, so inferred."""

from dataclasses import replace

from pipeline.profiles.nv2a import NV2A


def _inferred(evidence):
    """What was measured on the NV2A is inferred here."""
    if evidence.startswith("Measured:"):
        return f"Inferred: from the NV2A: {evidence.removeprefix('Measured: ')}"
    return evidence


GEFORCE_3 = replace(
    NV2A,
    name="GeForce 3",
    description="NVIDIA NV20, 2001: texture shaders, eight general combiners, four texture units",
    evidence={field: _inferred(evidence) for field, evidence in NV2A.evidence.items()},
)
