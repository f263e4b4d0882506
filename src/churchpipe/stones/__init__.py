"""From a building to its stones, and from stones to their contacts."""
