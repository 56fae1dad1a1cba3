-- The telemetry file that was given for a video.

ALTER TABLE videos ADD COLUMN telemetry text NOT NULL DEFAULT '';
