"""From a building to the mesh of its mid-surfaces."""
