"""Options, each declared once: properties, rows, arguments and keywords come of that."""
