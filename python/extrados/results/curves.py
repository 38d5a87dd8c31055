"""Reading curves that hold a value, or none, at some places."""


def least_beside(places: list[float], values: list[float | None], place: float) -> float | None:
    """The least value at the neighbours of a place; None where both have none."""
    order = sorted(zip(places, values, strict=True), key=lambda pair: abs(pair[0] - place))
    low = [pair for pair in order if pair[0] <= place][:1]
    high = [pair for pair in order if pair[0] >= place][:1]
    return min((value for _, value in low + high if value is not None), default=None)


def between(places: list[float], values: list[float | None], place: float) -> float | None:
    """The value at a place, on the straight line between its neighbours; None outside, and beside a null unless the place is one of `places`."""
    pairs = sorted(zip(places, values, strict=True), key=lambda pair: pair[0])
    for (x0, y0), (x1, y1) in zip(pairs, [*pairs[1:], pairs[-1]], strict=True):
        if x0 == place:
            return y0
        if x0 <= place <= x1 and y0 is not None and y1 is not None:
            return y0 + (y1 - y0) * (place - x0) / (x1 - x0)
    return None
