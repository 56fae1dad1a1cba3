-- The fields of view of telemetry. docs/formats/index.md describes every table and column.

-- How an error of the focal length shifts the line of sight.
ALTER TABLE sightings ADD COLUMN focal_shift BLOB;
