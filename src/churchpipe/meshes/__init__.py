"""Meshes and models of other programs to stones: OBJ, STL, PLY, GLB, 3MF, Rhino, COMPAS, LMGC90, 3DEC."""
