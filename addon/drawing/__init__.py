"""Drawing that panels share."""
