"""Figures for readers: sheets for a page or a slide, and animations. They show the machine's own pixels."""
