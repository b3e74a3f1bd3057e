"""The recipes that there are."""

from spectral_tv.bands.settings import Settings

from .recipe import Recipe

RECIPES = (
    Recipe(
        "Exaggerate Skin",
        "Raise wrinkles, scales and folds; the body and its proportions stay",
        Settings("M1"),
        (0.7, 1.2, 1.1, 0.6, 0.0),
        icon="MOD_NOISE",
    ),
    Recipe(
        "Clean Scan",
        "Remove the noise of a scan, as much as is found; sharp edges stay",
        Settings("M1", steps=24, keep_limbs=0.0),
        cleans=True,
        icon="BRUSH_DATA",
    ),
    Recipe(
        "Caricature",
        "Exaggerate limbs, head and features, and calm the skin a little",
        Settings("M1", keep_limbs=0.5),
        (-0.6, 0.0, 1.0, 1.2, 1.2),
        icon="MONKEY",
    ),
    Recipe(
        "Flatten Plates",
        "Flatten what lies on plates, muscles and folds; their outlines stay crisp",
        Settings("M3"),
        (-1.0, -0.9, -0.6, -0.2, 0.0),
        icon="MOD_BEVEL",
    ),
    Recipe(
        "Stylize",
        "Few and large forms, as if carved: fine detail goes, large folds rise",
        Settings("M3"),
        (-0.9, -0.6, 0.0, 0.6, 0.9),
        icon="SCULPTMODE_HLT",
    ),
)
