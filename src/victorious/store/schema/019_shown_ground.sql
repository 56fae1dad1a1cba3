-- The ground that the cameras may have shown. docs/formats/index.md describes every table and column.

CREATE TABLE shown_ground (
  video_id  INTEGER NOT NULL REFERENCES videos (id) ON DELETE CASCADE,
  south_rad REAL NOT NULL,
  west_rad  REAL NOT NULL,
  north_rad REAL NOT NULL,
  east_rad  REAL NOT NULL
) STRICT;
CREATE INDEX shown_ground_by_video ON shown_ground (video_id);
CREATE INDEX shown_ground_by_place ON shown_ground (south_rad, north_rad, west_rad, east_rad, video_id);
ALTER TABLE videos ADD COLUMN has_shown_ground INTEGER NOT NULL DEFAULT 0;
