-- Names only: the states and events of tasks have the names of those of jobs (store/work_state.h).

ALTER TABLE tasks DROP CONSTRAINT tasks_state_check;
UPDATE tasks SET state = CASE state WHEN 'waiting' THEN 'queued' ELSE 'failed' END WHERE state IN ('waiting', 'quarantined');
ALTER TABLE tasks ALTER COLUMN state SET DEFAULT 'queued',
  ADD CONSTRAINT tasks_state_check CHECK (state IN ('queued', 'running', 'done', 'failed'));
DROP INDEX tasks_waiting;
CREATE INDEX tasks_queued ON tasks (priority, id) WHERE state = 'queued';

ALTER TABLE task_log DROP CONSTRAINT task_log_event_check;
UPDATE task_log SET event = 'released' WHERE event = 'returned';
ALTER TABLE task_log ADD CONSTRAINT task_log_event_check
  CHECK (event IN ('claimed', 'done', 'released', 'failed', 'lost'));
