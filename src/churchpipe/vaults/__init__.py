"""How stones lie in vaults and domes: sections of courses, and the paths along which they are swept."""
