-- For the next `netcert update`: all changes since the extract of `run.input_blake3`, deflated, and the sequence number of the last one if
-- it came from a folder of replication. At most one row; none after `ingest`.
CREATE TABLE map_change (
    map_change_no INTEGER PRIMARY KEY NOT NULL,
    sequence INTEGER,
    changes BLOB NOT NULL
);
