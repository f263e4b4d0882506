"""The case file: read, checked, multiplied by its sweep, and split into the settings of each stage."""
