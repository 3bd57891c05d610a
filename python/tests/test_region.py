"""A database that the program made, read from Python."""

import csv
import io
import json
import multiprocessing
import os
import pickle

import netcert
import numpy
import pytest
import shapely

TRUCK, TUG = "AU-SEMI19", "AGV-TUG4"


def test_edges_and_turns_are_those_of_the_program(demo, demo_path, run):
    for vehicle_id in (TRUCK, TUG):
        shown = list(csv.DictReader(io.StringIO(run("query", "-q", "--db", demo_path, "--vehicle", vehicle_id, "--format", "csv"))))
        rows = demo.edges(vehicle_id).to_pyarrow().to_pylist()
        assert len(rows) == len(shown) > 100
        for row, known in zip(rows, shown, strict=True):
            for name, text in known.items():
                value = row[name]
                same = text == "" if value is None else (str(value) == text or float(text) == value)
                assert same, (name, value, text)
        turns = demo.turns(vehicle_id)
        assert len(turns) > 100 and "turn_id" in turns.column_names


def test_filters_are_those_of_the_program(demo):
    everything = demo.edges(TRUCK).to_pandas()
    safe = demo.edges(TRUCK, verdict="safe", min_rsc_m=0.3).to_pandas()
    wanted = everything[(everything.verdict == "safe") & (everything.rsc_m >= 0.3)]
    assert safe.edge_id.tolist() == wanted.edge_id.tolist() and 0 < len(safe) < len(everything)
    one = int(everything.edge_id.iloc[5])
    assert demo.edges(TRUCK, edge_id=one).to_pandas().edge_id.tolist() == [one]
    frame = demo.edges(TRUCK).to_geopandas()
    west, south, east, north = frame.total_bounds
    half = (west, south, (west + east) / 2, north)
    inside = demo.edges(TRUCK, bbox=half).to_geopandas()
    assert inside.edge_id.tolist() == frame[frame.intersects(_box(half))].edge_id.tolist()


def _box(bounds):
    import shapely

    return shapely.box(*bounds)


def test_other_packages_take_the_rows_as_they_are(demo):
    import duckdb
    import polars
    import pyarrow

    table = demo.edges(TRUCK)
    arrow = pyarrow.table(table)
    assert arrow.num_rows == len(table) == len(polars.from_arrow(arrow)) == len(table.to_polars())
    counted = duckdb.sql("SELECT count(*) FILTER (verdict = 'safe') FROM arrow").fetchall()
    assert counted == [(len(demo.edges(TRUCK, verdict="safe")),)]
    # The stream can be read again, and its columns are not copied.
    again = pyarrow.table(table)
    address = [each.column("rsc_m").chunk(0).buffers()[1].address for each in (arrow, again)]
    assert address[0] == address[1]


def test_lines_have_a_place_on_earth(demo):
    frame = demo.edges(TRUCK).to_geopandas()
    assert frame.crs == "EPSG:4326" and set(frame.geom_type) == {"LineString"}
    metres = frame.to_crs(frame.estimate_utm_crs()).length
    assert ((metres - frame.length_m).abs() < 0.02 * frame.length_m + 2).mean() > 0.95


def test_sets_and_vehicles_are_named(demo, catalogue):
    sets = {known.vehicle_id: known for known in demo.sets()}
    assert set(sets) == {TRUCK, TUG} and sets[TUG].corridor == demo.usual_corridor == "carriageway"
    assert sets[TUG].turns and sets[TUG].settings["station_spacing_m"] == 1.0
    assert demo.vehicle(TRUCK) == catalogue[TRUCK]
    with pytest.raises(netcert.NotFound, match="no vehicle EU-SEMI16.5"):
        demo.vehicle("EU-SEMI16.5")


def safe_turn(demo):
    turn = demo.turns(TUG, verdict="safe").to_pandas().iloc[0]
    places = []
    for edge_id in (turn.from_edge, turn.to_edge):
        line = demo.edges(TUG, edge_id=int(edge_id)).to_geopandas().geometry.iloc[0]
        point = line.interpolate(0.5, normalized=True)
        places.append((point.x, point.y))
    return turn, places


def test_a_route_is_that_of_the_program(demo, demo_path, run, tmp_path):
    _, (start, end) = safe_turn(demo)
    found = demo.route(TUG, start, end)
    asked = [",".join(map(str, place)) for place in (start, end)]
    told = json.loads(run("route", "-q", "--db", demo_path, "--vehicle", TUG, "--from", asked[0], "--to", asked[1], "--format", "json"))
    assert found.to_dict() == told and len(found) == 1
    best = found[0]
    assert best.safe and best.verdict == "safe" and best.conditions == [] and best.rsc_m > 0
    assert best.parts[0].from_m == 0 and best.parts[-1].to_m == pytest.approx(best.length_m, abs=1.5)
    assert {part.kind for part in best.parts} >= {"edge", "turn"}
    path = tmp_path / "route.json"
    best.to_file(path)
    assert netcert.verify(path).confirmed
    assert best.to_svg().startswith("<svg")
    frame = found.to_geopandas()
    assert (frame.kind == "route").sum() == 1


def test_a_route_that_is_not_there_names_what_blocks(demo):
    _, (start, end) = safe_turn(demo)
    frame = demo.edges(TRUCK).to_geopandas()
    answers = []
    for line in frame.geometry.iloc[:: max(1, len(frame) // 12)]:
        middle = line.interpolate(0.5, normalized=True)
        answers.append(demo.route(TRUCK, start, (middle.x, middle.y), conditions=False))
    blocked = [answer for answer in answers if answer.obstacles]
    assert blocked, "one of these places should be out of reach"
    obstacle = blocked[0].obstacles[0]
    assert obstacle.title and obstacle.verdict in ("unsafe", "unknown", "forbidden", "refuted")
    assert obstacle.place is not None and len(blocked[0]) == 0 and blocked[0].conditional is None


class OnlyANarrowRing:
    """An answer without a route even under conditions, as `netcert route` writes it."""

    place = {"kind": "roundabout", "from_edge": 7, "to_edge": 8, "title": "High Street over the roundabout into Mill Lane"}

    def to_dict(self):
        nothing_helps = [{**self.place, "place": [8.5, 49.4]}]
        return {"routes": [], "conditional": None, "obstacles": [], "nothing_helps": nothing_helps}

    def to_geojson(self):
        geometry = {"type": "Point", "coordinates": [8.5, 49.4]}
        properties = {**self.place, "feature": "nothing_helps", "vehicle_id": "EU-SEMI16.5"}
        return {"type": "FeatureCollection", "features": [{"type": "Feature", "geometry": geometry, "properties": properties}]}


def test_a_place_that_no_condition_opens_is_named_and_drawn():
    found = netcert.Routes(OnlyANarrowRing())
    [ring] = found.nothing_helps
    assert (ring.kind, ring.place, ring.ids) == ("roundabout", (8.5, 49.4), {"from_edge": 7, "to_edge": 8})
    drawn = found.explore(tiles=None).get_root().render()
    assert "over the roundabout into Mill Lane: nothing that was tried opens it" in drawn


def test_a_conditional_route_is_never_safe(demo):
    frame = demo.edges(TRUCK, verdict="unsafe").to_geopandas()
    _, (start, _) = safe_turn(demo)
    for line in frame.geometry.iloc[:: max(1, len(frame) // 12)]:
        middle = line.interpolate(0.5, normalized=True)
        answer = demo.route(TRUCK, start, (middle.x, middle.y))
        if answer.conditional is not None:
            break
    else:
        pytest.fail("none of these places has a conditional route")
    route = answer.conditional
    assert (route.verdict, route.safe, len(answer)) == ("conditional", False, 0)
    assert route.conditions and all(condition.needed > 0 for condition in route.conditions)
    assert json.loads(route.certificate())["verdict"] == "conditional"


def test_the_narrowest_certified_strip_is_a_column_and_a_filter(demo):
    for rows in (demo.edges, demo.turns):
        frame = rows(TRUCK).to_pandas()
        # The file has certificates of the carriageway alone.
        assert ((frame["verdict"] == "safe") == (frame["uses"] == "carriageway")).all()
        assert len(rows(TRUCK, uses="carriageway")) == (frame["verdict"] == "safe").sum() > 0
        with pytest.raises(netcert.NotFound, match="under the lane policy"):
            rows(TRUCK, uses="lane")


def test_what_a_region_lacks_is_named(demo, tmp_path):
    with pytest.raises(netcert.NotFound, match="netcert certify --vehicle EU-SEMI16.5"):
        demo.edges("EU-SEMI16.5")
    with pytest.raises(netcert.NotFound, match="no edge or turn 7"):
        demo.explain_edge(7, TRUCK)
    with pytest.raises(netcert.PlaceError, match="road that may be used"):
        demo.route(TUG, (0.0, 0.0), (1.0, 1.0))
    for wrong in ({"verdict": "good"}, {"bbox": (0, 9, 1, 2)}, {"corridor": "road"}, {"min_width_source": "?"}, {"uses": "?"}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            demo.edges(TRUCK, **wrong)
    with pytest.raises(ValueError, match="is no place"):
        demo.route(TUG, (500.0, 0.0), (1.0, 1.0))
    other = tmp_path / "other.gpkg"
    other.write_bytes(b"not a database")
    for path in (other, tmp_path / "missing.gpkg"):
        with pytest.raises(netcert.RegionError, match=path.name):
            netcert.open(path)


@pytest.mark.parametrize(
    ("name", "wrong"), [("min_rsc_m", "wide"), ("bbox", (0, 9, 1)), ("bbox", 5), ("edge_id", 1.5), ("edge_id", 2**70), ("verdict", 3)]
)
def test_a_filter_of_a_wrong_kind_is_named(demo, name, wrong):
    with pytest.raises((TypeError, ValueError, OverflowError)) as raised:
        demo.edges(TRUCK, **{name: wrong})
    # Python 3.10 has no notes.
    assert getattr(raised.value, "__notes__", [f"while processing '{name}'"]) == [f"while processing '{name}'"]


def test_an_explanation_says_what_the_program_says(demo, demo_path, run):
    edge_id = int(demo.edges(TRUCK, verdict="unsafe").to_pandas().edge_id.iloc[0])
    why = demo.explain_edge(edge_id, TRUCK)
    told = json.loads(run("explain", "-q", edge_id, "--db", demo_path, "--vehicle", TRUCK, "--format", "json"))
    assert why.headline in json.dumps(told) and why.verdict == "unsafe"
    assert why.to_geojson()["type"] == "FeatureCollection"
    turn, _ = safe_turn(demo)
    assert demo.explain_turn(int(turn.turn_id), TUG).verdict == "safe"


def test_the_checker_says_what_the_program_says(demo, demo_path, run, tmp_path):
    found = demo.verify(vehicles=[TRUCK], sample=40)
    assert found.confirmed and found.complaints == [] and "all confirmed" in repr(found)
    said = run("verify", "-q", "--db", demo_path, "--vehicle", TRUCK, "--sample", "40").splitlines()[1:]
    counted = [[row["vehicle_id"], row["corridor"], row["of"] + "s", row["verdict"], *(str(row[name]) for name in
               ("confirmed", "not_confirmed", "malformed"))] for row in found.counts]
    assert [line.split() for line in said] == counted
    assert sum(row["confirmed"] for row in found.counts) == 80
    with pytest.raises(netcert.NotFound, match="no such certificates"):
        demo.verify(vehicles=["NOBODY"])
    with pytest.raises(FileNotFoundError):
        demo.verify(sample=1, source=tmp_path / "no-such-file")


def test_the_checker_refutes_a_certificate_that_promises_too_much(demo_path, tmp_path):
    import shutil
    import sqlite3

    path = tmp_path / "bold.gpkg"
    shutil.copy(demo_path, path)
    with sqlite3.connect(path) as database:
        database.execute(
            "UPDATE certificate_compact SET rsc_mm = rsc_mm + 50 WHERE certificate_no = (SELECT min(fid) FROM certificate"
            " WHERE verdict = 'safe' AND vehicle_id = ?)",
            [TRUCK],
        )
    found = netcert.open(path).verify(vehicles=[TRUCK])
    edges = [complaint for complaint in found.complaints if f"{TRUCK} edge " in complaint]
    assert not found.confirmed and len(edges) == 1 and edges[0].startswith("not confirmed: ")


def test_places_are_pairs_arrays_or_points(demo):
    _, (start, end) = safe_turn(demo)
    told = demo.route(TUG, start, end).to_dict()
    kinds = (list, numpy.array, shapely.Point, lambda place: shapely.Point(*place, 12.0))
    for kind in kinds:
        assert demo.route(TUG, kind(start), kind(end), via=[]).to_dict() == told
    for wrong in ("8.6,49.4", "12", {1.0, 2.0}, (1.0,), (1.0, "east"), None, 7):
        with pytest.raises(ValueError, match=r"start: .* is no place; expected a pair"):
            demo.route(TUG, wrong, end)
    with pytest.raises(ValueError, match=r"via\[1\]: "):
        demo.route(TUG, start, end, via=[start, ()])


def test_regions_and_tables_go_to_other_processes(demo):
    again = pickle.loads(pickle.dumps(demo))
    table = demo.edges(TUG)
    assert again.edges(TUG).to_pyarrow().equals(table.to_pyarrow())
    copy = pickle.loads(pickle.dumps(table))
    assert copy.to_pyarrow().equals(table.to_pyarrow()) and len(copy) == len(table) and copy.columns == table.columns
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(edges_of, (demo,)) == len(table)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
def test_a_forked_process_is_told_to_open_the_region_again(demo):
    with multiprocessing.get_context("fork").Pool(1, initializer=keep, initargs=(demo,)) as pool:
        told = pool.apply_async(ask_kept).get(timeout=60)
    assert "open it again" in told


def edges_of(region):
    return len(region.edges(TUG))


def keep(region):
    global kept
    kept = region


def ask_kept():
    try:
        kept.edges(TUG)
    except netcert.RegionError as error:
        return str(error)
    return "no error"


def test_a_route_may_rest_on_attested_places_alone(demo):
    _, (start, end) = safe_turn(demo)
    assert demo.route(TUG, start, end, at_most="attested").to_dict() == demo.route(TUG, start, end).to_dict()
    # Nothing attests the vehicle here, so no condition is allowed.
    for line in demo.edges(TRUCK, verdict="unsafe").to_geopandas().geometry.iloc[::9]:
        middle = line.interpolate(0.5, normalized=True)
        answer = demo.route(TRUCK, start, (middle.x, middle.y))
        if answer.conditional is not None:
            break
    assert answer.conditional.conditions_attested is False
    assert demo.route(TRUCK, start, (middle.x, middle.y), at_most="attested").conditional is None
    with pytest.raises(ValueError, match='wider than `corridor`, or "attested"'):
        demo.route(TUG, start, end, corridor="carriageway", at_most="lane")


def test_routes_are_a_sequence(demo):
    _, (start, end) = safe_turn(demo)
    routes = demo.route(TUG, start, end)
    assert routes[numpy.int64(0)] is routes[0] and routes[:1] == [routes[0]] and routes[-1:] == list(routes)[-1:]
