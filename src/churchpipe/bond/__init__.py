"""How stones lie in a wall: bonds, junctions and voussoirs, in the flat coordinates of the wall's chart."""
