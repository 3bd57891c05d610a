"""python3 -m unittest tools/test_measure.py"""

import contextlib
import io
import sqlite3
import tempfile
import unittest
from importlib.machinery import SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path

HERE = Path(__file__).resolve().parent
loader = SourceFileLoader("measure", str(HERE / "measure"))
measure = module_from_spec(spec_from_loader("measure", loader))
loader.exec_module(measure)


def definitions():
    return {
        "page": {"text": "Words.", "inputs": "Where from."},
        "input": [{"id": "a", "name": "Region A", "file": "a.osm.pbf", "source": "somewhere"}],
        "section": [{"id": "s", "title": "Time and memory"}],
        "table": [{"id": "t", "section": "s", "title": "Ingest", "keys": ["input"], "columns": ["wall", "user"]}],
        "measurement": [{"id": "m", "command": ["{netcert} ingest {input} --db {db}"], "inputs": ["a"]}],
        "readme": [{"question": "How long?", "answer": "{0}", "figures": [["t", ["Region A"], "wall"]]}],
    }


def cell(column, value, unit="s"):
    return {"table": "t", "row": ["Region A"], "column": column, "value": value, "unit": unit}


def run(cells, commit="1234567", date="2026-01-02"):
    return {
        "measurement": "m",
        "input": "a",
        "sha256": "ab" * 32,
        "command": ["netcert ingest REGION.osm.pbf"],
        "commit": commit,
        "machine": "one core",
        "date": date,
        "cells": cells,
    }


class Reading(unittest.TestCase):
    def values(self, value, output="", **names):
        done = [{"stdout": output, "stderr": "", "wall": 1.25, "user": 1.0, "peak": 10.0}]
        return measure.read_value(value, done, names)

    def test_patterns_find_labels_and_figures(self):
        found = self.values({"regex": r"(\w+): ([\d.]+) mm"}, "wide: 1.5 mm\ntight: 2.5 mm\n")
        self.assertEqual(found, [("wide", "1.5"), ("tight", "2.5")])

    def test_json_paths_go_through_lists(self):
        self.assertEqual(self.values({"json": "routes.0.rsc_m"}, '{"routes": [{"rsc_m": 0.2}]}'), [(0.2,)])

    def test_queries_read_the_database(self):
        with tempfile.TemporaryDirectory() as folder:
            path = f"{folder}/region.gpkg"
            with contextlib.closing(sqlite3.connect(path)) as database, database:
                database.execute("CREATE TABLE edge AS SELECT 'primary' AS highway, 7 AS length_m")
            self.assertEqual(self.values({"sql": "SELECT highway, length_m FROM edge"}, db=path), [("primary", 7)])

    def test_labels_become_rows_and_columns(self):
        one = {"id": "m", "value": [{"table": "t", "row": ["{place}"], "column": "{0}", "regex": r"(\w+) (\d+)", "scale": 0.1}]}
        done = [{"stdout": "wall 30", "stderr": ""}]
        made = measure.cells_of(one, done, {"place": "Region A"})
        self.assertEqual(made, [cell("wall", 3, "")])

    def test_a_figure_that_is_not_there_is_an_error(self):
        one = {"id": "m", "value": [{"table": "t", "row": ["x"], "column": "wall", "regex": "nothing"}]}
        with self.assertRaisesRegex(measure.Failure, "nothing found"):
            measure.cells_of(one, [{"stdout": "", "stderr": ""}], {})


class Running(unittest.TestCase):
    def test_a_command_that_fails_says_what_it_said(self):
        with self.assertRaisesRegex(measure.Failure, "status 3:\nno such road"):
            measure.execute(["sh", "-c", "echo no such road >&2; exit 3"])

    def test_a_command_that_may_fail_is_read(self):
        self.assertEqual(measure.execute(["sh", "-c", "echo 5; exit 3"], may_fail=True)["stdout"], "5\n")

    def test_an_extract_that_is_missing_names_its_source(self):
        with self.assertRaisesRegex(measure.Failure, "get it from somewhere"):
            measure.find_input(definitions()["input"][0], Path("/nowhere"))

    def test_an_unknown_measurement_is_named(self):
        with self.assertRaisesRegex(measure.Failure, "no measurement x;"):
            measure.chosen(definitions(), ["x"])

    def test_a_program_from_elsewhere_has_no_commit(self):
        self.assertEqual(measure.commit_of(Path("/usr/bin/netcert"), None), measure.UNKNOWN)

    def test_a_later_figure_replaces_the_earlier(self):
        results = {"runs": [run([cell("wall", 1), cell("user", 1)])]}
        measure.merge(results, run([cell("wall", 2)], commit="89abcde"))
        self.assertEqual([(r["commit"], [c["value"] for c in r["cells"]]) for r in results["runs"]], [("1234567", [1]), ("89abcde", [2])])
        measure.merge(results, run([cell("user", 3)], commit="89abcde"))
        self.assertEqual([r["commit"] for r in results["runs"]], ["89abcde", "89abcde"])


class Writing(unittest.TestCase):
    def test_the_page_has_figure_command_hash_commit_machine_and_date(self):
        text = measure.page(definitions(), {"runs": [run([cell("wall", 1234.5)])]})
        self.assertIn("| Region A | 1,234.5 s | 1 |", text)
        self.assertIn("| 1 | `netcert ingest REGION.osm.pbf` | `a.osm.pbf` abababababab | 1234567 | A | 2026-01-02 |", text)
        self.assertIn("| A | one core |", text)

    def test_the_page_does_not_depend_on_the_order_of_runs(self):
        runs = [run([cell("wall", 1)]), run([cell("user", 2)], commit="89abcde")]
        self.assertEqual(measure.page(definitions(), {"runs": runs}), measure.page(definitions(), {"runs": runs[::-1]}))

    def test_results_survive_being_written(self):
        results = {"runs": [run([cell("wall", 1.5), cell("user", "1 to 2")])]}
        self.assertEqual(measure.json.loads(measure.dump_results(results)), results)

    def test_the_readme_table_stands_between_its_marks(self):
        table = measure.readme_table(definitions(), {"runs": [run([cell("wall", 2)])]})
        self.assertIn("| How long? | 2 s | [table](docs/measurements.md#ingest) |", table)
        text = measure.with_table(f"before\n{measure.BEGIN}\nold\n{measure.END}\nafter\n", table)
        self.assertEqual(text, f"before\n{measure.BEGIN}\n{table}\n{measure.END}\nafter\n")
        with self.assertRaises(measure.Failure):
            measure.with_table("no marks", table)

    def test_definitions_with_a_table_that_is_not_there_are_refused(self):
        wrong = definitions()
        wrong["measurement"][0]["value"] = [{"table": "x", "row": ["a"], "column": "b", "given": 0}]
        with self.assertRaisesRegex(measure.Failure, "no table x"):
            measure.check_definitions(wrong)

    def test_the_repository_s_page_is_what_write_gives(self):
        with contextlib.redirect_stderr(io.StringIO()) as said:
            self.assertEqual(measure.main(["check"]), 0, said.getvalue())


if __name__ == "__main__":
    unittest.main()
