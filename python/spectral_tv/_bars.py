"""A bar of progress."""

from collections.abc import Callable

from spectral_tv._optional import needed


def progress_bar(description: str | None = None) -> Callable[[float], None]:
    """Make a bar of tqdm for an argument `progress`: in a notebook a widget, elsewhere text.

    Parameters
    ----------
    description : str, optional
        What stands before the bar.

    Returns
    -------
    callable
        It takes the fraction done, and is for one piece of work. The bar ends at 1.

    Raises
    ------
    ImportError
        If there is no tqdm: the extra `notebook` brings it.
    """
    auto = needed("tqdm.auto", "progress_bar()", "notebook")
    bar_format = "{l_bar}{bar}| {elapsed}<{remaining}"
    bar = auto.tqdm(total=1.0, desc=description, bar_format=bar_format)

    def tell(fraction: float) -> None:
        bar.update(fraction - bar.n)
        if fraction >= 1.0:
            bar.close()

    return tell
