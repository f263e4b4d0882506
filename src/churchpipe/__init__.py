"""churchpipe: collapse load factors of masonry buildings.

The public names stand in `__init__.pyi`; each is loaded when it is first used, so that `import churchpipe` costs nothing.
"""

from typing import Any

import lazy_loader

from churchpipe.compilation import keep_compiled as _keep_compiled

# Before numba is loaded, which reads the place once.
_keep_compiled()
_load, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    found = _load(name)
    if isinstance(found, type) and hasattr(found, "__dataclass_fields__"):
        # Its annotations, which a case file is read by, are none to be read by people.
        from churchpipe.model.readable import described

        return described(found)
    return found
