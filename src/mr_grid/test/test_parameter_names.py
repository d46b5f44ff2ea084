"""What a misspelt parameter is told."""

from mr_grid.parameter_names import unknown_parameters


def test_what_is_not_known_is_named_with_the_nearest_that_is() -> None:
    assert unknown_parameters({"resolution": 1, "map_fram": "map"}, {"resolution", "map_frame"}) == [
        "parameter map_fram is unknown, is map_frame meant?"
    ]
    assert unknown_parameters(["x"], ["resolution"]) == ["parameter x is unknown"]
    assert unknown_parameters([], ["resolution"]) == []
