"""How stones lie: bonds, junctions and voussoirs in flat chart coordinates, and their lift into space."""
