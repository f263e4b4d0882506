"""From the stones of a drawing to the walls that they belong to."""
