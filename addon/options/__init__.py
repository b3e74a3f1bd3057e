"""Options: each is declared once, and becomes a property, a row, an argument and a keyword."""
