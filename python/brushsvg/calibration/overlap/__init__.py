"""Fit a brush whose predicted marks overlap best with the painted marks."""
