-- Attempts that were killed from outside are counted apart from those that failed by the task itself.

ALTER TABLE tasks ADD COLUMN kills bigint NOT NULL DEFAULT 0;
