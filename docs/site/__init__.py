"""The pages of docs/ as a site, opened from its folder: ``python -m docs.site``, ``make site``."""
