"""Pictures of a run: the solution, its error, the shape on its grid, the convergence of a study."""

from rfm.app.pictures.gallery import Gallery, solution_figure

__all__ = ["Gallery", "solution_figure"]
