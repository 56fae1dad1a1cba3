-- Work that `victorious serve` does for its users. docs/formats/index.md describes every table and column.

CREATE TABLE jobs (
  id               INTEGER PRIMARY KEY AUTOINCREMENT,
  kind             TEXT NOT NULL,
  input            TEXT NOT NULL,
  state            TEXT NOT NULL,
  created_utc_us   INTEGER NOT NULL,
  started_utc_us   INTEGER,
  ended_utc_us     INTEGER,
  owner            TEXT,
  lease_utc_us     INTEGER,
  attempts         INTEGER NOT NULL DEFAULT 0,
  cancel_asked     INTEGER NOT NULL DEFAULT 0,
  done             INTEGER NOT NULL DEFAULT 0,
  total            INTEGER,
  unit             TEXT NOT NULL DEFAULT '',
  message          TEXT NOT NULL DEFAULT ''
) STRICT;
CREATE INDEX jobs_by_state ON jobs (state, id);
