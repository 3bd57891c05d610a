"""Rows of a database, as other packages read them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    import geopandas
    import pandas
    import polars
    import pyarrow

    from ._netcert import RowBatches


def pandas_type(kind: pyarrow.DataType) -> pandas.Int64Dtype | None:
    """The type in pandas of an Arrow column: `Int64` for whole numbers, whether or not a row lacks one. None leaves the choice to pandas.

    Of its own accord pandas makes doubles of a column with gaps, and they round ids of 63 bits.
    """
    import pandas
    import pyarrow

    return pandas.Int64Dtype() if pyarrow.types.is_integer(kind) else None


class Table:
    """Rows in memory as Arrow record batches.

    Every package that reads Arrow's C stream interface takes a table as it is and copies nothing: `pyarrow.table(t)`,
    `polars.DataFrame(t)`, `duckdb.from_arrow(t)`. `docs/columns.md` describes the columns. Where rows have a place, the column
    `geometry` holds lines of longitudes and latitudes (GeoArrow, EPSG:4326 with longitude first).
    """

    def __init__(self, rows: RowBatches | pyarrow.Table) -> None:
        self._rows = rows

    def __reduce__(self) -> tuple[Any, tuple[bytes]]:
        # As Arrow's stream: pyarrow 26 pickles lists of fixed size without the names of their items, and GeoArrow has such lists.
        import pyarrow

        rows, sink = self.to_pyarrow(), pyarrow.BufferOutputStream()
        with pyarrow.ipc.new_stream(sink, rows.schema) as stream:
            stream.write_table(rows)
        return _of_stream, (sink.getvalue().to_pybytes(),)

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        return self._rows.__arrow_c_stream__(requested_schema)

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def column_names(self) -> list[str]:
        """Names of the columns."""
        return self._rows.column_names

    @property
    def columns(self) -> list[str]:
        """Names of the columns, as pandas and polars call them."""
        return self.column_names

    @property
    def schema(self) -> pyarrow.Schema:
        """Names and Arrow types of the columns."""
        return self.to_pyarrow().schema

    @property
    def nbytes(self) -> int:
        """Bytes of all columns."""
        return self._rows.nbytes

    def head(self, rows: int = 5) -> Table:
        """The first rows."""
        return Table(self.to_pyarrow().slice(0, max(rows, 0)))

    def to_pyarrow(self, *, geometry: Literal["geoarrow", "wkb"] = "geoarrow") -> pyarrow.Table:
        """The rows as a pyarrow table.

        geometry  how lines are kept: "geoarrow" as lists of longitudes and latitudes, and nothing is copied; "wkb" as binary for
                  readers that know no GeoArrow, which needs GeoPandas
        """
        import pyarrow

        if geometry not in ("geoarrow", "wkb"):
            raise ValueError(f'geometry: {geometry!r}; expected "geoarrow" or "wkb"')
        table = pyarrow.table(self)
        if geometry == "geoarrow" or "geometry" not in table.column_names:
            return table
        import geopandas

        lines = geopandas.GeoDataFrame.from_arrow(table.select(["geometry"])).to_arrow(geometry_encoding="WKB")
        binary = pyarrow.table(lines)
        at = table.column_names.index("geometry")
        return table.set_column(at, binary.schema.field("geometry"), binary.column("geometry"))

    def to_pandas(self) -> pandas.DataFrame:
        """The rows as a DataFrame without `geometry`. `to_geopandas` has the lines, too.

        Columns of whole numbers are `Int64`, which has room for gaps and for ids of 63 bits.
        """
        return _without_lines(self.to_pyarrow())

    def to_polars(self) -> polars.DataFrame:
        """The rows as a polars DataFrame."""
        import polars

        frame = polars.from_arrow(self.to_pyarrow())
        if not isinstance(frame, polars.DataFrame):
            raise TypeError("polars made no DataFrame of the rows")
        return frame

    def to_geopandas(self) -> geopandas.GeoDataFrame:
        """The rows as a GeoDataFrame in EPSG:4326, longitude first. Columns have the types of `to_pandas`."""
        import geopandas

        if "geometry" not in self.column_names:
            raise ValueError("these rows have no place; use to_pandas()")
        return geopandas.GeoDataFrame.from_arrow(self.to_pyarrow(), to_pandas_kwargs={"types_mapper": pandas_type})

    def explore(self, **options: Any) -> Any:
        """The rows on a map that one can move (folium), coloured by verdict. Options are those of `folium.Map`.

        The map's background comes from the internet; `tiles=None` leaves it out.
        """
        from .maps import table

        return table(self, **options)

    def __repr__(self) -> str:
        return f"<Table: {len(self)} rows, {len(self.column_names)} columns>"

    def _repr_html_(self) -> str:
        shown = _without_lines(self.to_pyarrow().slice(0, 10)).to_html(index=False, border=0)
        return f"{shown}<p>{len(self)} rows × {len(self.column_names)} columns</p>"


def _of_stream(stream: bytes) -> Table:
    """The table of a stream in Arrow's format."""
    import pyarrow

    return Table(pyarrow.ipc.open_stream(stream).read_all())


def _without_lines(table: pyarrow.Table) -> pandas.DataFrame:
    """The rows as a DataFrame without `geometry`."""
    if "geometry" in table.column_names:
        table = table.drop_columns(["geometry"])
    return table.to_pandas(types_mapper=pandas_type)
