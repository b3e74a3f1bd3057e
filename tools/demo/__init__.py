"""The demo: a figure, decomposed and filtered, on one contact sheet."""
