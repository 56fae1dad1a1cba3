-- Times of live sources that were searched, and tasks without an end.

CREATE TABLE covered_times (
  video_id    bigint NOT NULL REFERENCES videos (id) ON DELETE CASCADE,
  from_frame  bigint NOT NULL,
  source      text NOT NULL,
  from_utc_us bigint NOT NULL,
  to_utc_us   bigint NOT NULL,
  PRIMARY KEY (video_id, from_frame)
);
CREATE INDEX covered_times_by_source ON covered_times (source, from_utc_us);

ALTER TABLE tasks ADD COLUMN is_lasting boolean NOT NULL DEFAULT false,
  ADD COLUMN is_ending boolean NOT NULL DEFAULT false;
CREATE INDEX tasks_lasting ON tasks (id) WHERE is_lasting;
