"""Colours shared by the pictures, the plots and the viewer."""

SPEED_STOPS = ("#e9e3d8", "#f2cf8d", "#ee9d4e", "#d65a34", "#8f1d2c")
PLASTIC_STOPS = ("#f1efea", "#cfdde6", "#86b3d1", "#3a76ad", "#14366b")
# For labelled areas, told apart by colour-blind people too (Tol, Colour schemes, SRON 2021, "light").
PANELS = ("#77aadd", "#ee8866", "#eedd88", "#ffaabb", "#99ddff", "#44bb99", "#bbcc33", "#aaaa00")
# For lines, likewise (Okabe and Ito, Color Universal Design, 2008, without the yellow, which is pale on white).
LINES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#2b2b2b", "#882255")
# The stone that was picked.
PICKED = "#0d3b66"
# The stone across the joint that was picked.
ACROSS = "#4aa3df"
SUPPORT = "#b9b6b0"
EDGE = "#4a4038"
GROUND = "#dcd6ca"
PUSH = "#2f5d8a"
TIE = "#1d6b3a"
LOAD = "#6b4c9a"
BEAM = "#b8cde0"
JOINT = "#c0392b"
INK = "#2b2b2b"
ALARM = "#b3402a"
