-- What the steer axle is to follow through a turn, as `plan` has it for strokes: one row for each turn (by its `fid`) and vehicle whose
-- certificate rests on a plan that is not the centreline of the turn's path (`path_no`).

CREATE TABLE turn_plan (
    vehicle_no INTEGER NOT NULL,
    corridor_no INTEGER NOT NULL,
    fid INTEGER NOT NULL,
    coefficients BLOB NOT NULL,
    PRIMARY KEY (vehicle_no, corridor_no, fid)
) WITHOUT ROWID;
