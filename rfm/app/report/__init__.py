"""The report of a run: one HTML file that carries everything it shows."""

from rfm.app.report.builder import report_html

__all__ = ["report_html"]
