-- What data association keeps from one run for the next. docs/formats/index.md describes every table and column.

-- Changes with the sightings of the tracklet.
ALTER TABLE tracklets ADD COLUMN revision INTEGER NOT NULL DEFAULT 0;

-- The path is the last column: who reads the others does not read its pages.
CREATE TABLE kept_fits (
  tracklet_id INTEGER NOT NULL REFERENCES tracklets (id) ON DELETE CASCADE,
  key         INTEGER NOT NULL,
  fit         BLOB NOT NULL,
  path        BLOB,
  PRIMARY KEY (tracklet_id, key)
) STRICT;
