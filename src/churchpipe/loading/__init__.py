"""Where loads, ties and beams act: from names of walls and places to stones and facets, one rule for both models."""
