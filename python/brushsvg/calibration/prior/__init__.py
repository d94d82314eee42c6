"""Update a known brush by a painted job."""
