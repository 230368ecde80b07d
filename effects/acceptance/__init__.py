"""What figures and studies measure with: checks, measures, rays, agreement."""
