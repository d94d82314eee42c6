"""A brush whose predicted marks overlap best with the painted ones."""
