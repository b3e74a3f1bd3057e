"""The formats that pictures are written in, and what each of them can hold."""

from spectral_tv.dataclass import dataclass

# The depths, from the shallowest, and how messages call them.
DEPTHS = {"8": "8 bits", "16": "16 bits", "half": "floats of 16 bits", "float": "floats of 32 bits"}
# How many steps there are up to 1, of integers.
STEPS = {"8": 255, "16": 65535}
HALF_MAX = 65504.0
# The depths that hold all that each of them does.
HOLDING = {
    "8": ("8", "16", "half", "float"),
    "16": ("16", "float"),
    "half": ("half", "float"),
    "float": ("float",),
}


@dataclass(frozen=True)
class Format:
    """What a file of a format can hold; ``name`` is Blender's."""

    name: str
    suffixes: tuple[str, ...]
    depths: tuple[str, ...]
    # Whether one channel, with alpha too, is written as one.
    holds_grey: bool = False
    holds_grey_alpha: bool = False
    # Whether colors are multiplied by alpha; None if the file tells.
    is_associated: bool | None = False
    holds_profile: bool = False
    holds_resolution: bool = False
    # By default, of formats that have one, in percent; 100 loses nothing in WebP.
    quality: int | None = None
    # Whether colors under alpha 0 are lost.
    loses_hidden: bool = False

    @property
    def is_linear(self) -> bool:
        """Whether colors in it are scene-linear by convention."""
        return self.name == "OPEN_EXR"

    def holding(self, depth: str) -> list[str]:
        """Its depths that hold what that one does, the shallowest first."""
        return [each for each in self.depths if each in HOLDING[depth]]

    def depth_for(self, depth: str) -> str:
        """The shallowest of its depths that holds what that one does, or its deepest."""
        return next(iter(self.holding(depth)), self.depths[-1])


FORMATS = (
    Format("PNG", (".png",), ("8", "16"), holds_grey=True, holds_profile=True,
           holds_resolution=True),
    Format("JPEG", (".jpg", ".jpeg"), ("8",), holds_grey=True, holds_profile=True,
           holds_resolution=True, quality=95),
    Format("TIFF", (".tif", ".tiff"), ("8", "16", "float"), holds_grey=True, holds_grey_alpha=True,
           is_associated=None, holds_profile=True, holds_resolution=True),
    Format("WEBP", (".webp",), ("8",), quality=100, loses_hidden=True),
    Format("BMP", (".bmp",), ("8",), holds_grey=True),
    Format("TARGA", (".tga",), ("8",), holds_grey=True),
    Format("OPEN_EXR", (".exr",), ("half", "float"), is_associated=True),
)  # fmt: skip
BY_SUFFIX = {suffix: form for form in FORMATS for suffix in form.suffixes}
