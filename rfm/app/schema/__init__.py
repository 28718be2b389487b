"""The schema of a case file, one module per section."""
