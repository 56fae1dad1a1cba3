-- Frames in which a search for the shape of a tracked object did not find it.

ALTER TABLE sightings ADD COLUMN is_missed bigint NOT NULL DEFAULT 0;
