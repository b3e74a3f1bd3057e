"""Files: written whole or not at all, and told from those that were cut short."""
