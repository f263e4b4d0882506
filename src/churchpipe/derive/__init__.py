"""From a building, or from stones, to the models that are analysed."""
