-- The fields of view of telemetry.

-- How an error of the focal length shifts the line of sight.
ALTER TABLE sightings ADD COLUMN focal_shift bytea;
