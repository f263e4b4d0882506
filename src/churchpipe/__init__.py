"""churchpipe: collapse load factors of masonry buildings."""
