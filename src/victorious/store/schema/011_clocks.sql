-- The clocks of telemetry. docs/formats/index.md describes every table and column.

-- Photos: the times of their frames are invented.
ALTER TABLE videos ADD COLUMN is_of_photos INTEGER NOT NULL DEFAULT 0;
-- How an error of the clock shifts the line of sight.
ALTER TABLE sightings ADD COLUMN clock_shift BLOB;
