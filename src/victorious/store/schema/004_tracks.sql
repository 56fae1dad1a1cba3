-- Which sightings are of one thing that was followed. docs/formats/index.md describes every table and column.

ALTER TABLE sightings ADD COLUMN track INTEGER;
