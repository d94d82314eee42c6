"""What a plan needs beside compensation: refinement, order, size."""
