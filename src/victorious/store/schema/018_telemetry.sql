-- The telemetry file that was given for a video. docs/formats/index.md describes every table and column.

ALTER TABLE videos ADD COLUMN telemetry TEXT NOT NULL DEFAULT '';
