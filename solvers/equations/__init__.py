"""One file per equation; each is its energy density, its flux and its strong residual."""
