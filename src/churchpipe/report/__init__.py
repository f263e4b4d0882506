"""What a user keeps: report.html, pictures, plots."""
