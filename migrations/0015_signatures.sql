-- Who vouches for the content of this file: at most one signature of each key. `statement` is the signed text, JSON; `value` its
-- Ed25519 signature, hexadecimal. The statement has a hash of every other table, so any change outside of this table shows.
CREATE TABLE signature (
    signature_no INTEGER PRIMARY KEY,
    public_key TEXT NOT NULL UNIQUE,
    statement TEXT NOT NULL,
    value TEXT NOT NULL
);
