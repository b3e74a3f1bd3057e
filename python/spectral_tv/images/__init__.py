"""Pictures: what of them flows, and what formats hold of the result."""
