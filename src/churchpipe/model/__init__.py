"""Data only: frozen dataclasses of NumPy arrays."""
