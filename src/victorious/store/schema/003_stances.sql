-- How objects stand before the camera, where their points tell. docs/formats/index.md describes every table and column.

ALTER TABLE sightings ADD COLUMN view_sigma_rad REAL;
ALTER TABLE sightings ADD COLUMN distance_m REAL;
ALTER TABLE sightings ADD COLUMN distance_sigma_m REAL;
