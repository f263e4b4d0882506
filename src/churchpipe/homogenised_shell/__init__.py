"""The homogenised shell: strength and stiffness of the running-bond cell, the flat facet, equations (4)-(10)."""
