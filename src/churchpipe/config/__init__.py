"""The case file: read, checked, multiplied by its sweep, and split into the settings of each stage."""

from churchpipe.config.analyses import RigidSettings, ShellSettings
from churchpipe.config.case import Case, Drawing, Generated, read_case, read_variants

__all__ = ["Case", "Drawing", "Generated", "RigidSettings", "ShellSettings", "read_case", "read_variants"]
