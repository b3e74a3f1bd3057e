"""Drawing that panels share, and the preferences that it goes by; works without the package."""

FILES = ("preferences",)
FORGET = ("sizes.forget",)
