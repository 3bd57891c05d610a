"""Vehicles and catalogues."""

import json
import pickle
from collections.abc import Mapping

import netcert
import pytest


def test_a_catalogue_is_a_mapping_and_says_what_the_program_says(catalogue, run):
    assert isinstance(catalogue, Mapping)
    assert list(catalogue) == list(catalogue.keys()) and len(catalogue) == len(catalogue.values())
    shown = json.loads(run("vehicles", "show", "AU-BDOUBLE26", "--format", "json"))
    assert catalogue["AU-BDOUBLE26"].to_dict()["unit"] == shown["unit"]
    assert catalogue.get("nothing") is None and catalogue.get("nothing", 3) == 3


def test_an_unknown_id_is_a_key_error_with_the_nearest_ids(catalogue):
    with pytest.raises(KeyError) as error:
        catalogue["AU-BDOUBLE27"]
    assert isinstance(error.value, netcert.UnknownVehicle)
    assert str(error.value).startswith('no vehicle "AU-BDOUBLE27" in the catalogue; did you mean AU-BDOUBLE26')


def test_definitions_and_pickles_give_the_same_vehicle(catalogue):
    for vehicle in catalogue.values():
        assert netcert.Vehicle.from_dict(vehicle.to_dict()) == vehicle
        assert pickle.loads(pickle.dumps(vehicle)) == vehicle


def test_a_wrong_definition_names_every_fault():
    with pytest.raises(netcert.VehicleError) as error:
        netcert.Vehicle.from_dict({"id": "X", "unit": [{"coupling_to_axle_m": -1, "width_m": 99}]})
    assert "coupling_to_axle_m" in str(error.value) and "width_m" in str(error.value)


def test_a_file_of_ones_own_adds_to_the_catalogue(tmp_path):
    file = tmp_path / "ours.toml"
    file.write_text('[[vehicle]]\nid = "OURS"\n[[vehicle.unit]]\ncoupling_to_axle_m = 4.5\n')
    assert netcert.vehicles(file)["OURS"].units[0].coupling_to_axle_m == 4.5
    file.write_text("[[vehicle]]\n")
    with pytest.raises(netcert.VehicleError, match="ours.toml"):
        netcert.vehicles(file)


def test_vehicles_of_a_country(catalogue):
    ids = [vehicle.id for vehicle in catalogue.for_country("de")]
    assert "EU-SEMI16.5" in ids and "US-WB67" not in ids
    with pytest.raises(ValueError, match="two letters"):
        catalogue.for_country("Germany")
