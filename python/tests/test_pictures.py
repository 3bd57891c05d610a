"""Plots and maps. Somebody has to look at them; these tests see that they show what they should."""

import matplotlib
import netcert
import pytest

matplotlib.use("Agg")


def test_a_plot_shows_the_place_and_the_leeway(catalogue, bend, tmp_path):
    made = netcert.certify(bend, catalogue["AU-BDOUBLE26"])
    figure = made.plot()
    place, along = figure.axes
    assert figure.get_suptitle().startswith("AU-BDOUBLE26: ")
    low, high = place.get_xlim()
    assert low < made.limiting.s_m < high
    assert {line.get_label() for line in along.lines} >= {"left of the road", "right of the road"}
    figure.savefig(tmp_path / "plot.png")
    assert (tmp_path / "plot.png").stat().st_size > 10_000


def test_a_plot_goes_into_axes_of_ones_own(catalogue, bend):
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots()
    assert netcert.certify(bend, catalogue["EU-SEMI16.5"]).plot(ax) is figure and len(ax.lines) > 2


def test_a_vehicle_without_bounds_is_drawn_too(catalogue):
    corridor = netcert.Corridor([[0, 0], [40, 0], [45, 6], [40, 12], [0, 12]], width_m=5.0)
    made = netcert.certify(corridor, catalogue["AU-ATRIPLE53"])
    assert not made.safe
    assert "unsafe" in made.plot().get_suptitle()


def test_maps_show_every_row_and_route(demo):
    table = demo.edges("AU-SEMI19", verdict="unsafe")
    drawn = table.explore(tiles=None).get_root().render()
    assert drawn.count('"verdict": "unsafe"') == len(table)
    edges = demo.edges("AGV-TUG4", verdict="safe").to_geopandas().geometry
    ends = [edge.interpolate(0.5, normalized=True) for edge in edges.iloc[:2]]
    found = demo.route("AGV-TUG4", *[(end.x, end.y) for end in ends])
    assert "Path" in found.explore(tiles=None).get_root().render() or "polyline" in found.explore(tiles=None).get_root().render()


def test_rows_without_a_place_have_no_map(catalogue, bend):
    table = netcert.certify_many([bend], [catalogue["EU-SEMI16.5"]])
    with pytest.raises(ValueError, match="no place"):
        table.to_geopandas()
