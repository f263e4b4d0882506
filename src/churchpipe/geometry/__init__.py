"""Plane regions, charts, clusters and solids: what every layer above needs of geometry."""
