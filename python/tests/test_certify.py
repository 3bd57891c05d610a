"""Certificates of corridors from arrays."""

import json
import math
import threading
import time

import netcert
import numpy as np
import pytest


def ring(radius_m: float, turns: float = 0.5) -> np.ndarray:
    angle = np.linspace(0, 2 * math.pi * turns, 400)
    return radius_m * np.column_stack([np.sin(angle), 1 - np.cos(angle)])


def test_the_certificate_is_that_of_the_program(catalogue, bend, run, tmp_path):
    drawn, written, ours = tmp_path / "bend.json", tmp_path / "program.json", tmp_path / "python.json"
    drawn.write_text(json.dumps({"frame": "metres", "points": [[0, 0], [60, 0], [120, 15]], "width_m": 7.0}))
    for vehicle_id in ("EU-SEMI16.5", "AU-ATRIPLE53", "AGV-TUG4"):
        run("corridor", drawn, "--vehicle", vehicle_id, "--out", written)
        netcert.certify(bend, catalogue[vehicle_id]).to_file(ours)
        assert ours.read_bytes() == written.read_bytes()
        assert "not confirmed" not in run("verify", ours)


def test_lists_and_arrays_of_any_order_and_kind_give_the_same_corridor():
    points = [[0, 0], [60, 0], [120, 15]]
    known = netcert.Corridor(points, left_m=3.5, right_m=3.5)
    others = (np.array(points), np.array(points, dtype=np.float32), np.asfortranarray(points), np.array(points * 2)[:3])
    for other in others:
        again = netcert.Corridor(other, width_m=[7.0, 7.0, 7.0])
        assert np.array_equal(again.xy, known.xy) and np.array_equal(again.left_m, known.left_m)


def test_a_closed_form_stands_behind_the_numbers(catalogue):
    """On a long circle the rear axle of a rigid vehicle follows at sqrt(R² - L²)."""
    vehicle = netcert.Vehicle.from_dict({"id": "RIGID", "unit": [{"coupling_to_axle_m": 6.0}]})
    corridor = netcert.Corridor(ring(40.0), width_m=12.0, smoothing_tolerance_m=0)
    tube = netcert.certify(corridor, vehicle, max_shift_m=0).tubes()[0]
    middle = len(tube) // 2
    radius = np.hypot(*(tube.centre[middle] - [0, 40.0]))
    assert radius == pytest.approx(math.sqrt(40.0**2 - 6.0**2), abs=0.02)


def test_arrays_have_one_entry_per_station_and_none_is_negative_where_safe(catalogue, bend):
    made = netcert.certify(bend, catalogue["EU-SEMI16.5"])
    count = len(bend)
    assert bend.xy.shape == made.plan.shape == (count, 2)
    for column in (made.shift_m, made.left_m, made.right_m, made.left_centred_m, bend.curvature, bend.heading_rad):
        assert column.shape == (count,)
    assert made.safe and np.nanmin([made.left_m, made.right_m]) >= made.rsc_m - 0.01
    assert made.limiting.side in ("left", "right") and 0 <= made.limiting.s_m <= bend.length_m


def test_more_width_never_gives_less_room(catalogue):
    vehicle = catalogue["AU-BDOUBLE26"]
    room = [netcert.certify(netcert.Corridor(ring(60.0), width_m=w), vehicle).rsc_m for w in (4.0, 6.0, 8.0)]
    assert room[0] < 0 < room[2] and room == sorted(room)


def test_degrees_come_back_as_degrees():
    points = np.array([[8.68, 49.41], [8.69, 49.41], [8.695, 49.413]])
    corridor = netcert.Corridor(points, width_m=7.0, crs="lonlat")
    assert np.allclose(corridor.coordinates[[0, -1]], points[[0, -1]], atol=1e-5)
    assert "tmerc" in corridor.proj


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"points": [[0, 0], [9, 0]]}, "width_m: missing"),
        ({"points": [[0, 0], [9, 0]], "width_m": -1}, "width_m: -1 is not a width"),
        ({"points": [[0, 0], [9, math.nan]], "width_m": 3}, "points"),
        ({"points": [[0, 0, 0], [9, 0, 0]], "width_m": 3}, r"points: an array of shape \(2, 3\)"),
        ({"points": [], "width_m": 3}, "points: no array of two dimensions"),
        ({"points": "abc", "width_m": 3}, "points: no array"),
        ({"points": [[0, 0], [9, 0]], "width_m": "3"}, "width_m: expected a number of metres"),
        ({"points": [[0, 0], [9, 0]], "left_m": 3, "right_m": [[1]]}, "right_m: expected a number of metres"),
        ({"points": [[0, 0], [9, 0]], "width_m": [3, 3, 3]}, "3 values for 2 points"),
        ({"points": [[0, 0], [9, 95]], "width_m": 3, "crs": "lonlat"}, "latitude 95"),
        ({"points": [[0, 0], [9, 0]], "width_m": 3, "crs": "feet"}, "crs"),
    ],
)
def test_what_is_wrong_is_named(arguments, words):
    with pytest.raises(ValueError, match=words):
        netcert.Corridor(**arguments)


def test_options_out_of_range_are_refused(catalogue, bend):
    for wrong in ({"max_shift_m": math.nan}, {"max_shift_m": -1}, {"correction_sweeps": 1_000_000}):
        with pytest.raises(ValueError, match=next(iter(wrong))):
            netcert.certify(bend, catalogue["EU-SEMI16.5"], **wrong)


def test_the_checker_refutes_a_changed_file(catalogue, bend, tmp_path):
    made, path = netcert.certify(bend, catalogue["EU-SEMI16.5"]), tmp_path / "certificate.json"
    assert made.verify().confirmed
    path.write_text(made.to_json().replace('"safe":true', '"safe":false'))
    report = netcert.verify(path)
    assert not report.confirmed and report.findings
    with pytest.raises(FileNotFoundError, match="no-such-file"):
        netcert.verify(tmp_path / "no-such-file")


def test_an_explanation_says_why_and_what_would_do(catalogue):
    made = netcert.certify(netcert.Corridor(ring(30.0), width_m=4.0), catalogue["AU-BDOUBLE26"])
    why = made.explain()
    assert (why.verdict, made.reason) == ("unsafe", "width")
    assert why.headline.startswith("unsafe:") and why.hints and "model" in why.scope
    assert why.to_svg().startswith("<svg") and why.to_geojson() is None


def test_many_give_the_numbers_of_one_by_one(catalogue):
    corridors = [netcert.Corridor(ring(radius), width_m=width) for radius in (25.0, 60.0) for width in (4.0, 9.0)]
    vehicles = list(catalogue.values())[:9]
    rows = netcert.certify_many(corridors, vehicles).to_pyarrow().to_pylist()
    assert len(rows) == len(corridors) * len(vehicles)
    for number, row in enumerate(rows):
        made = netcert.certify(corridors[number // len(vehicles)], vehicles[number % len(vehicles)])
        assert row["corridor"] == number // len(vehicles) and row["vehicle_id"] == made.vehicle.id
        assert (row["verdict"], row["reason"], row["rsc_m"]) == (made.verdict, made.reason, made.rsc_m)


def long_corridor() -> netcert.Corridor:
    s = np.arange(0, 60_000.0, 5.0)
    return netcert.Corridor(np.column_stack([s, 30 * np.sin(s / 120)]), width_m=7.0)


def test_ctrl_c_interrupts_and_the_next_call_works(catalogue, bend):
    """A signal arrives while the kernel works, as Ctrl-C sends it."""
    import _thread
    import signal

    corridor, vehicle = long_corridor(), catalogue["AU-ATRIPLE53"]
    # A shell starts a command in the background with this signal ignored. Python then ignores it, too.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.3, _thread.interrupt_main)
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            for _ in range(1000):
                netcert.certify(corridor, vehicle)
    finally:
        timer.join()
        signal.signal(signal.SIGINT, before)
    assert netcert.certify(bend, catalogue["EU-SEMI16.5"]).safe


def test_other_threads_go_on_while_the_kernel_works(catalogue):
    corridor, vehicle = long_corridor(), catalogue["AU-ATRIPLE53"]
    ticks, done = 0, threading.Event()

    def tick():
        nonlocal ticks
        while not done.is_set():
            ticks += 1
            time.sleep(0.001)

    counter = threading.Thread(target=tick)
    counter.start()
    netcert.certify(corridor, vehicle)
    counted = ticks
    done.set()
    counter.join()
    assert counted >= 3


def test_a_forked_process_has_threads_of_its_own(catalogue, bend):
    import multiprocessing

    netcert.certify(bend, catalogue["EU-SEMI16.5"])
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert pool.apply_async(_safe_in_a_child).get(timeout=120)


def _safe_in_a_child() -> bool:
    corridor = netcert.Corridor([[0, 0], [60, 0], [120, 15]], width_m=7.0)
    return netcert.certify(corridor, netcert.vehicles()["EU-SEMI16.5"]).safe
