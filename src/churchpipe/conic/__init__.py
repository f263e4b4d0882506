"""Cone programs and their solvers: matrices and cones, no masonry."""
