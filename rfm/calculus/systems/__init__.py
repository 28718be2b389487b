"""Systems of R-functions, one concept to a file; `rfm.calculus.r_systems` is the entrance."""
