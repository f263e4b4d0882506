"""What a user keeps: report.html, pictures, plots."""

from churchpipe.report.html import write_report

__all__ = ["write_report"]
