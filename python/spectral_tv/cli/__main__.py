"""``python -m spectral_tv.cli``."""

from spectral_tv.cli import main

main()
