-- What a segment needs of what was prepared for its video, so that no worker reads all of it for each.

ALTER TABLE segments ADD COLUMN prepared bytea;
