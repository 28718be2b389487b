"""The program: case files, the command, runs, reports, the Python entry."""
