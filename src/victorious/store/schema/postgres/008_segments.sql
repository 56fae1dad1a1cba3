-- Videos that several workers search at once, segment by segment. docs/formats/index.md describes every table and column.

CREATE TABLE video_cuts (
  id       bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  video_id bigint NOT NULL REFERENCES videos (id) ON DELETE CASCADE,
  models   bigint[] NOT NULL,
  plan     text NOT NULL,
  step     bigint NOT NULL,
  is_whole boolean NOT NULL DEFAULT false,
  prepared bytea NOT NULL
);
CREATE UNIQUE INDEX video_cuts_by_plan ON video_cuts (video_id, md5(plan));

CREATE TABLE segments (
  cut_id     bigint NOT NULL REFERENCES video_cuts (id) ON DELETE CASCADE,
  from_frame bigint NOT NULL,
  to_frame   bigint NOT NULL,
  state      text NOT NULL DEFAULT 'open' CHECK (state IN ('open', 'done', 'quarantined')),
  reason     text NOT NULL DEFAULT '',
  results    bytea,
  PRIMARY KEY (cut_id, from_frame)
);

-- Frames that were left out of a search. Deleted with it.
CREATE TABLE gaps (
  video_id   bigint NOT NULL,
  model_id   bigint NOT NULL,
  from_frame bigint NOT NULL,
  to_frame   bigint NOT NULL,
  from_s     double precision NOT NULL,
  to_s       double precision NOT NULL,
  reason     text NOT NULL,
  PRIMARY KEY (video_id, model_id, from_frame),
  FOREIGN KEY (video_id, model_id) REFERENCES searches (video_id, model_id) ON DELETE CASCADE
);

-- The segments of a video are parts of its task, which waits for them.
ALTER TABLE tasks ADD COLUMN parent bigint REFERENCES tasks (id) ON DELETE CASCADE,
  ADD COLUMN is_fatal boolean NOT NULL DEFAULT false;
ALTER TABLE tasks DROP CONSTRAINT tasks_state_check;
ALTER TABLE tasks ADD CONSTRAINT tasks_state_check CHECK (state IN ('queued', 'waiting', 'running', 'done', 'failed'));
DROP INDEX tasks_queued;
-- A video that was begun is ended before the next one.
CREATE INDEX tasks_queued ON tasks (priority, coalesce(parent, id), id) WHERE state = 'queued';
CREATE INDEX tasks_by_parent ON tasks (parent) WHERE parent IS NOT NULL;
CREATE INDEX tasks_waiting ON tasks (id) WHERE state = 'waiting';
