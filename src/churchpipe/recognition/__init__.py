"""From the stones of a drawing to the walls they stand in."""
