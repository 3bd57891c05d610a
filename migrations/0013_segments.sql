-- Of a database that was made from Overture's files: the segment of each way, and the part of it (shares of its length). Empty for others.
CREATE TABLE segment (
    way_id INTEGER PRIMARY KEY NOT NULL,
    segment_id TEXT NOT NULL,
    from_share REAL NOT NULL,
    to_share REAL NOT NULL
);
