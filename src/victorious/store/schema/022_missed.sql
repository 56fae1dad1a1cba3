-- Frames in which a search for the shape of a tracked object did not find it. docs/formats/index.md describes every table
-- and column.

ALTER TABLE sightings ADD COLUMN is_missed INTEGER NOT NULL DEFAULT 0;
