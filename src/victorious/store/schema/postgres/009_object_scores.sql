-- A score of each object over all its sightings, and what speaks against it.

ALTER TABLE objects ADD COLUMN object_score double precision;
ALTER TABLE objects ADD COLUMN against text;
ALTER TABLE objects ADD COLUMN evidence text;
