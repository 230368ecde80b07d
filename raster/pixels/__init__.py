"""Whole images: pixel transfer, accumulation, rectangles. No fragments."""
