"""Artifact formats: what the stages hand to each other, and what a user opens elsewhere."""
