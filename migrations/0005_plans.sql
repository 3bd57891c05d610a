-- What the steer axle is to follow, so that certificates can be checked again without planning again: one row for each
-- stroke (by its first edge) and vehicle whose plan is not the centreline. `coefficients`: the plan's integer spline coefficients,
-- packed as store/plans.rs says.

CREATE TABLE plan (
    vehicle_no INTEGER NOT NULL,
    corridor_no INTEGER NOT NULL,
    fid INTEGER NOT NULL,
    coefficients BLOB NOT NULL,
    PRIMARY KEY (vehicle_no, corridor_no, fid)
) WITHOUT ROWID;
