-- The ground that the cameras may have shown.

CREATE TABLE shown_ground (
  video_id  bigint NOT NULL REFERENCES videos (id) ON DELETE CASCADE,
  south_rad double precision NOT NULL,
  west_rad  double precision NOT NULL,
  north_rad double precision NOT NULL,
  east_rad  double precision NOT NULL
);
CREATE INDEX shown_ground_by_video ON shown_ground (video_id);
CREATE INDEX shown_ground_by_place ON shown_ground (south_rad, north_rad, west_rad, east_rad, video_id);
ALTER TABLE videos ADD COLUMN has_shown_ground bigint NOT NULL DEFAULT 0;
