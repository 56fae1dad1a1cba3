-- Times of live sources that were searched. docs/formats/index.md describes every table and column.

CREATE TABLE covered_times (
  video_id    INTEGER NOT NULL REFERENCES videos (id) ON DELETE CASCADE,
  from_frame  INTEGER NOT NULL,
  source      TEXT NOT NULL,
  from_utc_us INTEGER NOT NULL,
  to_utc_us   INTEGER NOT NULL,
  PRIMARY KEY (video_id, from_frame)
) STRICT;
CREATE INDEX covered_times_by_source ON covered_times (source, from_utc_us);
