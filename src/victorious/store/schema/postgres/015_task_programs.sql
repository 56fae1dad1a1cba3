-- What a build does not do costs it nothing: the tasks of others are not read, nor are all videos for one.

DROP INDEX tasks_queued;
CREATE INDEX tasks_queued ON tasks (program, priority, coalesce(parent, id), id) WHERE state = 'queued';
CREATE INDEX videos_by_name ON videos (name);
