"""The examples of the reference paper: their cases, and what the runs of these give. paper/ reports on them, bench/ measures on them."""
