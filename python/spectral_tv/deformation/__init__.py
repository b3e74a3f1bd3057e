"""Moving parts of a mesh: the options, the parts, and what solves for the rest."""
