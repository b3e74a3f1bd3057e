"""Options: declared once, for operators, panels, command lines and the package."""
