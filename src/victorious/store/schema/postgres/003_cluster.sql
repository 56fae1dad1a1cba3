-- Ids of tracklets by video, so that they do not depend on which worker commits first.

-- Tracklets that the video ever had; ids of deleted ones are not used again.
ALTER TABLE videos ADD COLUMN tracklets_made bigint NOT NULL DEFAULT 0;
-- Above every present id, which were of one sequence.
UPDATE videos SET tracklets_made = (SELECT coalesce(max(id), 0) FROM tracklets);
ALTER TABLE tracklets ALTER COLUMN id DROP IDENTITY;

-- The build of the program that shall do the task, and the time before which it is not claimed.
ALTER TABLE tasks ADD COLUMN program text NOT NULL DEFAULT '', ADD COLUMN not_before timestamptz;

-- Attempts that failed or lost their worker, without progress.
ALTER TABLE tasks RENAME COLUMN lost_workers TO failures;
CREATE INDEX task_log_by_time ON task_log (at);
