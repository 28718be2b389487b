"""Solution structures: fields that satisfy boundary conditions whatever the unknown functions are."""
