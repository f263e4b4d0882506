"""CAD drawings to stones and back: the only package that knows ezdxf."""
