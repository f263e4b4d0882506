"""Rigid blocks at large displacements: capacity curves, settlements."""
