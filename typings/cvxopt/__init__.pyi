# Only what churchpipe uses.
from typing import Any

def spmatrix(values: Any, rows: Any, columns: Any, size: tuple[int, int]) -> Any: ...
