"""Colours shared by the pictures, the plots and the viewer."""

SPEED_STOPS = ("#e9e3d8", "#f2cf8d", "#ee9d4e", "#d65a34", "#8f1d2c")
PLASTIC_STOPS = ("#f1efea", "#cfdde6", "#86b3d1", "#3a76ad", "#14366b")
PANELS = (
    "#7d9ab5",
    "#d9a05b",
    "#8fb08c",
    "#b98a9a",
    "#c9bb7a",
    "#8c86b3",
    "#6fa8a3",
    "#c98b6b",
    "#9aa0a6",
    "#b5c26b",
)
SUPPORT = "#b9b6b0"
EDGE = "#4a4038"
GROUND = "#dcd6ca"
PUSH = "#2f5d8a"
TIE = "#1d6b3a"
LOAD = "#6b4c9a"
JOINT = "#c0392b"
INK = "#2b2b2b"
ALARM = "#b3402a"
