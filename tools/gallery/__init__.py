"""The figures of the paper, made by this library; see docs/gallery."""
